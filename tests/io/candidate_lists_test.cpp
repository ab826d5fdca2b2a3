// Tests of lists of candidates: writing them, reading them back, and errors in lists.

#include <nlohmann/json.hpp>
#include <sstream>

#include "feature_results.h"
#include "files.h"

namespace crumple::io::test {
namespace {

/// Returns one candidate of each kind, of one mesh or of two bodies. Edges 1 and 2 are 0 7 and 2 9; the latter belongs
/// to body 1.
Candidates example(bool has_bodies = false) {
    Candidates a;
    const std::int32_t other = has_bodies ? 1 : 0;
    a.listed.fill(true);
    add(a[CandidateKind::vertex_face], {7, 1}, {0, other}, has_bodies);
    add(a[CandidateKind::edge_edge], {1, 2}, {0, other}, has_bodies);
    add(a[CandidateKind::edge_face], {2, 3}, {other, 0}, has_bodies);
    add(a[CandidateKind::face_face], {4, 5}, {0, other}, has_bodies);
    add(a[CandidateKind::vertex_edge], {8, 1}, {other, 0}, has_bodies);
    add(a[CandidateKind::vertex_vertex], {3, 4}, {0, other}, has_bodies);
    a.count = 6;
    a.edges = array<Edge>({{0, 1}, {0, 7}, {2, 9}});
    a.first_edge = array<std::int64_t>({0, 3});
    if (has_bodies) {
        a.edges = array<Edge>({{0, 1}, {0, 7}, {2, 3}, {2, 4}, {2, 9}});
        a.first_edge = array<std::int64_t>({0, 2, 5});
    }
    a.statistics.pairs = 6;
    return a;
}

std::string written(const Candidates& candidates, PairFormat format) {
    std::ostringstream out;
    write_candidates(out, candidates, format);
    return out.str();
}

TEST(CandidateLists, text_has_one_line_per_candidate) {
    const std::string text = "vf 7 1\nee 0 7 2 9\nef 2 9 3\nff 4 5\nve 8 0 7\nvv 3 4\n";
    EXPECT_EQ(written(example(), PairFormat::txt), text);
    EXPECT_EQ(written(example(), PairFormat::automatic), text);
    EXPECT_EQ(written(example(true), PairFormat::txt),
              "vf 0:7 1:1\nee 0:0 0:7 1:2 1:9\nef 1:2 1:9 0:3\nff 0:4 1:5\nve 1:8 0:0 0:7\nvv 0:3 1:4\n");
    EXPECT_EQ(written(Candidates(), PairFormat::txt), "");
}

TEST(CandidateLists, csv_has_named_columns) {
    EXPECT_EQ(written(example(), PairFormat::csv),
              "kind,vertex,face,a,b,c,d\nvf,7,1,,,,\nee,,,0,7,2,9\nef,,3,2,9,,\nff,,4,5,,,\n"
              "ve,8,,0,7,,\nvv,3,,4,,,\n");
    EXPECT_TRUE(written(example(true), PairFormat::csv).ends_with("vv,0:3,,1:4,,,\n"));
}

TEST(CandidateLists, json_has_one_array_per_listed_kind) {
    using nlohmann::json;
    const auto all = json::parse(written(example(true), PairFormat::json));
    EXPECT_EQ(all["edge_faces"], json::parse("[[2,3]]"));
    EXPECT_EQ(all["edge_face_bodies"], json::parse("[[1,0]]"));
    EXPECT_EQ(all["vertex_faces"], json::parse("[[7,1]]"));
    EXPECT_EQ(all["edge_edges"], json::parse("[[1,2]]"));
    EXPECT_EQ(all["face_faces"], json::parse("[[4,5]]"));
    EXPECT_EQ(all["vertex_edges"], json::parse("[[8,1]]"));
    EXPECT_EQ(all["vertex_vertices"], json::parse("[[3,4]]"));
    EXPECT_EQ(all["edges"].size(), 5u);
    EXPECT_EQ(all["first_edge"], json::parse("[0,2,5]"));
    EXPECT_EQ(all["statistics"]["pairs"], 6);
    for (const char* const name : {"earliest", "vertex_face_toi", "vertex_face_", ""}) EXPECT_FALSE(all.contains(name));
    Candidates one;
    one.listed[static_cast<std::size_t>(CandidateKind::face_face)] = true;
    const auto few = json::parse(written(one, PairFormat::json));
    EXPECT_EQ(few["face_faces"], json::array());
    EXPECT_FALSE(few.contains("vertex_faces"));
}

TEST(CandidateLists, every_format_reads_back_what_was_written) {
    const Folder folder;
    for (const char* const name : {"a.txt", "a.csv", "a.json", "a.npz", "A.CSV"}) {
        for (const bool has_bodies : {false, true}) {
            write_candidates(folder / name, example(has_bodies));
            const CandidateRows list = read_candidates(folder / name);
            EXPECT_EQ(list.rows, list_of(example(has_bodies)).rows) << name;
            EXPECT_EQ(list.has_bodies, has_bodies) << name;
        }
        Candidates none;
        none.listed.fill(true);
        write_candidates(folder / name, none);
        EXPECT_TRUE(read_candidates(folder / name).rows.empty()) << name;
    }
}

TEST(CandidateLists, codimensional_points_are_named_by_their_vertices) {
    Candidates a = example();
    a.points = array<std::int32_t>({10, 11, 12, 13, 14, 15, 16, 17, 18});
    a.first_point = array<std::int64_t>({0, 9});
    EXPECT_EQ(written(a, PairFormat::txt), "vf 17 1\nee 0 7 2 9\nef 2 9 3\nff 4 5\nve 18 0 7\nvv 13 14\n");
}

TEST(CandidateLists, inconsistent_lists_are_refused) {
    const Folder folder;
    const auto refused = [&](auto spoil) {
        Candidates candidates = example(true);
        spoil(candidates);
        const Error error = error_of([&] { write_candidates(folder / "a.txt", candidates); });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_TRUE(contains(error.what(), "the lists of candidates do not fit together")) << error.what();
        EXPECT_FALSE(fs::exists(folder / "a.txt"));
    };
    refused([](Candidates& c) { c[CandidateKind::edge_face].pairs[0].a = 3; });
    refused([](Candidates& c) { c[CandidateKind::edge_face].bodies[0].first = 2; });
    refused([](Candidates& c) { c[CandidateKind::face_face].bodies = {}; });
    refused([](Candidates& c) { c.listed[static_cast<std::size_t>(CandidateKind::face_face)] = false; });
    EXPECT_EQ(error_of([&] { write_candidates(folder / "a.glb", example()); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { write_candidates(folder / "none" / "a.csv", example()); }).code, ErrorCode::file);
    for (const PairFormat format : {PairFormat::txt, PairFormat::csv, PairFormat::json, PairFormat::npz}) {
        std::ofstream closed;
        EXPECT_EQ(error_of([&] { write_candidates(closed, example(), format); }).code, ErrorCode::file);
    }
}

TEST(CandidateLists, edges_and_pairs_of_one_kind_read_the_same_in_either_order) {
    const Folder folder;
    const auto rows = [&](const std::string& text) { return read_candidates(folder.write("a.txt", text)).rows; };
    const auto expected = rows("ee 0 7 2 9\nef 2 9 3\nff 4 5\nve 8 0 7\nvv 3 4\n");
    EXPECT_EQ(expected, rows("# theirs\nee 9 2 7 0\n\nef 9 2 3\nff 5 4\nve 8 7 0\nvv 4 3"));
    EXPECT_EQ(read_candidates(folder.write("a.txt", "ff 1:4 0:5\n")).rows,
              read_candidates(folder.write("b.txt", "ff 0:5 1:4\n")).rows);
    EXPECT_NE(read_candidates(folder.write("a.txt", "ff 1:4 0:5\n")).rows,
              read_candidates(folder.write("b.txt", "ff 0:4 1:5\n")).rows);
    std::istringstream in("kind,vertex,face,a,b,c,d\nff,,5,4,,,\n");
    EXPECT_EQ(read_candidates(in, "in.csv").rows, rows("ff 4 5"));
}

void expect_refused(const std::string& name, const std::string& bytes, const std::string& what) {
    const Folder folder;
    const Error error = error_of([&] { read_candidates(folder.write(name, bytes)); });
    EXPECT_EQ(error.code, ErrorCode::format) << bytes;
    EXPECT_TRUE(contains(error.what(), name) && contains(error.what(), what)) << bytes << ": " << error.what();
}

TEST(CandidateLists, malformed_lists_are_refused) {
    expect_refused("a.txt", "vf 1 2\nff 1\n", "line 2: `ff` must be followed by 2 ids");
    expect_refused("a.txt", "vf 1 2 0.5\n", "line 1: unexpected '0.5' after the last value");
    expect_refused("a.txt", "fv 1 2\n", "'fv' is not vf, ee, ef, ff, ve or vv");
    expect_refused("a.txt", "ef 1 2 x\n", "'x' names no face");
    expect_refused("a.txt", "ff 1 -2\n", "'-2' names no face");
    expect_refused("a.txt", "ef 1 x 2\n", "'x' names no vertex");
    expect_refused("a.txt", "ef 1 1 2\n", "an edge names a vertex twice");
    expect_refused("a.txt", "ef 0:1 1:2 0:3\n", "an edge has vertices of two files");
    expect_refused("a.txt", "vv 1 2\nvv 0:1 1:2\n", "some ids have the number of a file and some do not");
    expect_refused("a.csv", "ff,,1,2,,\n", "6 columns instead of 7");
    expect_refused("a.csv", "ff,,1,,,,\n", "'' names no face");
    expect_refused("a.csv", "ff,7,1,2,,,\n", "'7' is in a column that this kind does not use");
    expect_refused("a.csv", "vf,7,1,,,,2\n", "'2' is in a column that this kind does not use");
    expect_refused("a.json", "{}", "it has none of the arrays");
    expect_refused("a.json", R"({"edge_faces":[[0,1]]})", "there is no array \"edges\"");
    expect_refused("a.json", R"({"edges":[[0,1]],"edge_faces":[[1,1]]})",
                   "row 0 of \"edge_faces\": there is no such edge");
    expect_refused("a.json", R"({"face_faces":[[0,1.5]]})", "row 0 of \"face_faces\": this is not a valid face");
    expect_refused("a.json", R"({"face_faces":[[0,1]],"face_face_bodies":[]})", "is not as long as");
    expect_refused("a.npz", "PK", "not a .npz archive");
    EXPECT_EQ(error_of([] { read_candidates("/nowhere/a.txt"); }).code, ErrorCode::file);
}

TEST(CandidateLists, unrelated_arrays_are_ignored) {
    const Folder folder;
    const std::string more = R"("vertex_face_":["theirs"],"vertex_face_toi":{},"":1,"face_faces":)";
    EXPECT_EQ(read_candidates(folder.write("a.json", "{" + more + "[[0,1]]}")).rows.size(), 1u);
    const std::string impacts = R"("vertex_faces":[],"vertex_face_toi":[],"edge_edges":[],"edge_edge_toi":[]})";
    EXPECT_TRUE(read_impacts(folder.write("a.json", R"({"edge_faces":"none",)" + impacts)).rows.empty());
    EXPECT_TRUE(contains(error_of([&] { read_impacts(folder.write("a.txt", "ef 1 2 3 0.5\n")); }).what(),
                         "is not vf, ee, ff, ve or vv"));
    EXPECT_TRUE(contains(error_of([&] { read_near(folder.write("a.txt", "ff 1 2 0.5\n")); }).what(),
                         "is not vf, ee, ve or vv"));
}

}  // namespace
}  // namespace crumple::io::test
