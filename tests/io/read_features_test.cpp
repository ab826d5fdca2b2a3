// Tests of reading lists of impacts and of near pairs that other programs may have written, and of errors in lists.

#include <random>
#include <sstream>

#include "feature_results.h"
#include "files.h"
#include "io/bytes/zip.h"
#include "numpy.h"

namespace crumple::io::test {
namespace {

FeatureRow face(std::int32_t vertex, std::int32_t triangle, double value, bool flag) {
    return {{CandidateKind::vertex_face, {0, 0}, {vertex, triangle, 0, 0}}, value, flag};
}

void expect_bad_rows(const std::string& bytes, const std::string& name, const std::string& what) {
    const Folder folder;
    const Error error = error_of([&] { read_impacts(folder.write(name, bytes)); });
    EXPECT_EQ(error.code, ErrorCode::format) << bytes << ": " << error.what();
    EXPECT_TRUE(contains(error.what(), name)) << error.what();
    EXPECT_TRUE(contains(error.what(), what)) << bytes << ": " << error.what();
}

TEST(FeatureReading, text_can_have_comments_and_lack_flags) {
    const Folder folder;
    const FeatureList list = read_impacts(folder.write(
        "a.txt", "# theirs\r\nvf 3 4 0.50000000000000000 0\r\n\r\n  vf\t5 6 0 # at the start\nvf 1 2 0 0"));
    EXPECT_EQ(list.rows, (std::vector<FeatureRow>{face(3, 4, 0.5, false), face(5, 6, 0, true), face(1, 2, 0, false)}));
    EXPECT_FALSE(list.has_bodies);
    EXPECT_TRUE(read_impacts(folder.write("empty.txt", "")).rows.empty());
}

TEST(FeatureReading, edges_and_their_vertices_can_come_in_any_order) {
    const Folder folder;
    const FeatureRow row{{CandidateKind::edge_edge, {0, 0}, {1, 8, 3, 5}}, 0.5, false};
    for (const char* const text : {"ee 1 8 3 5 0.5 0", "ee 1 8 5 3 0.5", "ee 8 1 3 5 0.5", "ee 8 1 5 3 0.5",
                                   "ee 3 5 1 8 0.5", "ee 3 5 8 1 0.5", "ee 5 3 1 8 0.5", "ee 5 3 8 1 0.5"})
        EXPECT_EQ(read_impacts(folder.write("a.txt", text)).rows, std::vector{row}) << text;
    const FeatureRow between{{CandidateKind::edge_edge, {0, 1}, {4, 5, 1, 2}}, 0.5, false};
    for (const char* const text : {"ee 0:4 0:5 1:1 1:2 0.5", "ee 1:2 1:1 0:5 0:4 0.5"}) {
        const FeatureList list = read_impacts(folder.write("a.txt", text));
        EXPECT_EQ(list.rows, std::vector{between}) << text;
        EXPECT_TRUE(list.has_bodies);
    }
}

TEST(FeatureReading, error_in_text_names_the_line) {
    const Folder folder;
    for (const char* const bad : {"v 1 2 0.5",
                                  "1 2 0.5",
                                  "vf",
                                  "vf 1",
                                  "vf 1 2",
                                  "vf 1 2 x",
                                  "vf a 2 0.5",
                                  "vf 1 -2 0.5",
                                  "vf 1 2.5 0.5",
                                  "vf 1 2147483648 0.5",
                                  "vf 99999999999999999999 2 0.5",
                                  "vf 1 2 1.5",
                                  "vf 1 2 -0.5",
                                  "vf 1 2 nan",
                                  "vf 1 2 inf",
                                  "vf 1 2 0.5 2",
                                  "vf 1 2 0.5 1",
                                  "vf 1 2 0.5 0 0",
                                  "vf 0: 2 0.5",
                                  "vf :1 2 0.5",
                                  "vf 0:1: 0:2 0.5",
                                  "vf 0:1 2 0.5",
                                  "vf 0:1 1:2 0.5",
                                  "ee 1 2 3 0.5",
                                  "ee 1 2 3 4",
                                  "ee 1 1 2 3 0.5",
                                  "ee 1 2 3 3 0.5",
                                  "ee 0:1 1:2 0:3 0:4 0.5",
                                  "vf,1,2,0.5"}) {
        const Error error = error_of(
            [&] { read_impacts(folder.write("a.txt", std::string("vf 0 1 0.5 0\n\n") + bad + "\nvf 4 5 1\n")); });
        EXPECT_EQ(error.code, ErrorCode::format) << bad;
        EXPECT_EQ(error.element, Element::line) << bad << ": " << error.what();
        EXPECT_EQ(error.index, 3) << error.what();
    }
    EXPECT_EQ(error_of([&] { read_impacts(folder / "missing.txt"); }).code, ErrorCode::file);
}

TEST(FeatureReading, squared_distances_can_be_large_or_infinite) {
    const Folder folder;
    const auto near = [&](const char* text) { return read_near(folder.write("a.txt", text)).rows; };
    EXPECT_EQ(near("vf 1 2 1e300\nvf 1 2 inf\nvf 1 2 0\n"),
              (std::vector{face(1, 2, 1e300, false), face(1, 2, HUGE_VAL, false), face(1, 2, 0, true)}));
    for (const char* const bad : {"vf 1 2 -1", "vf 1 2 nan", "vf 1 2 1 1"})
        EXPECT_EQ(error_of([&] { near(bad); }).code, ErrorCode::format) << bad;
}

TEST(FeatureReading, csv_can_lack_its_header_and_last_column) {
    const Folder folder;
    for (const char* const text : {"vf,3,4,,,,,0.5,0\n", "kind,vertex,face,a,b,c,d,toi\r\nvf, 3 ,4,,,,,0.5\r\n\r\n"})
        EXPECT_EQ(read_impacts(folder.write("a.csv", text)).rows, std::vector{face(3, 4, 0.5, false)}) << text;
}

TEST(FeatureReading, error_in_csv_names_the_line) {
    for (const char* const bad :
         {"vf", "vf,1,2", "vf,1,2,,,,,", "vf,1,2,,,,,0.5,0,0", "vf,1,2,3,,,,0.5", "vf,1,,,,,,0.5", "ee,,,1,2,3,,0.5",
          "ee,1,,1,2,3,4,0.5", "xx,1,2,,,,,0.5", "kind,1,2,,,,,0.5", "vf,1,2,,,,,0.5,yes", "vf 1 2 0.5"})
        expect_bad_rows(std::string("kind,vertex,face,a,b,c,d,toi,start\nvf,0,1,,,,,0.5,0\n") + bad + "\n", "a.csv",
                        "line 3");
}

/// Returns a list with one impact of each kind, in which `value` replaces the member `name`.
std::string json_with(const std::string& name, const std::string& value) {
    std::string text = "{\"more\": {\"edges\": [[[1]]]}";
    for (const auto& [member, usual] :
         std::vector<std::pair<std::string, std::string>>{{"vertex_faces", "[[0,1]]"},
                                                          {"vertex_face_toi", "[0.5]"},
                                                          {"vertex_face_start", "[0]"},
                                                          {"edges", "[[0,1],[2,3]]"},
                                                          {"edge_edges", "[[0,1]]"},
                                                          {"edge_edge_toi", "[0]"},
                                                          {"edge_edge_start", "[true]"}}) {
        const std::string& written = member == name ? value : usual;
        if (!written.empty()) text += ", \"" + member + "\": " + written;
    }
    return text + "}";
}

TEST(FeatureReading, json_can_hold_other_members) {
    const Folder folder;
    const FeatureRow edges{{CandidateKind::edge_edge, {0, 0}, {0, 1, 2, 3}}, 0, true};
    EXPECT_EQ(read_impacts(folder.write("a.json", json_with("", ""))).rows,
              (std::vector{face(0, 1, 0.5, false), edges}));
    EXPECT_EQ(read_impacts(folder.write("a.json", json_with("edge_edge_start", ""))).rows.back(), edges)
        << "a time of 0 is one at the start";
}

TEST(FeatureReading, malformed_json_is_an_error) {
    const auto bad = [](const char* name, const char* value, const std::string& what) {
        expect_bad_rows(json_with(name, value), "a.json", what);
    };
    for (const char* const value : {"[[0]]", "[[0,1,2]]", "[0,1]", "[[0,[1]]]", "[{}]", "[null]", "[[0,\"1\"]]"})
        bad("vertex_faces", value, "row 0 of \"vertex_faces\"");
    for (const char* const value : {"[[0,-1]]", "[[0,1.5]]", "[[0,2147483648]]", "[[0,null]]", "[[0,1e300]]"})
        bad("vertex_faces", value, "this is not a valid face");
    for (const char* const name : {"vertex_faces", "vertex_face_toi", "edges", "edge_edges", "edge_edge_toi"})
        for (const char* const value : {"", "1", "{}", "null", "\"x\""}) bad(name, value, "there is no array");
    bad("edges", "[[0,1],{}]", "row 1 of \"edges\"");
    bad("edges", "[[0,1],[2]]", "row 1 of \"edges\"");
    bad("vertex_face_toi", "[0.5,0.5]", "is not as long");
    bad("vertex_face_start", "[]", "is not as long");
    bad("vertex_face_toi", "[2]", "[0, 1]");
    bad("vertex_face_toi", "[[0.5]]", "row 0");
    bad("edge_edges", "[[0,2]]", "no such edge");
    bad("edges", "[[0,1],[2,2]]", "twice");
    expect_bad_rows("", "a.json", "byte 0");
    expect_bad_rows("[]", "a.json", "there is no array");
    expect_bad_rows(json_with("edges", "[[0,"), "a.json", "byte ");
    expect_bad_rows(std::string(100'000, '['), "a.json", "byte ");
}

TEST(FeatureReading, invalid_bodies_in_json_are_refused) {
    const auto list = [](const char* bodies, const char* first_edge) {
        return std::string(
                   R"({"vertex_faces": [], "vertex_face_toi": [], "edges": [[0,1],[2,3]], "edge_edges": [[0,0]],)") +
               R"("edge_edge_toi": [0.5], "edge_edge_bodies": )" + bodies + R"(, "first_edge": )" + first_edge + "}";
    };
    const Folder folder;
    const FeatureRow row{{CandidateKind::edge_edge, {0, 1}, {0, 1, 2, 3}}, 0.5, false};
    EXPECT_EQ(read_impacts(folder.write("a.json", list("[[0,1]]", "[0,1,2]"))).rows, std::vector{row});
    expect_bad_rows(list("[[0,2]]", "[0,1,2]"), "a.json", "no such body");
    expect_bad_rows(list("[[0,-1]]", "[0,1,2]"), "a.json", "this is not a valid body");
    expect_bad_rows(list("[[0,1]]", "[0,-1,2]"), "a.json", "this is not a valid edge");
    expect_bad_rows(list("[[0,1]]", "[0,2147483647,2]"), "a.json", "no such edge");
    expect_bad_rows(list("[[0,1],[0,1]]", "[0,1,2]"), "a.json", "is not as long");
}

/// Returns the same list as a .npz, in which `array` replaces the array `name`.
std::string npz_with(const std::string& name, const std::string& array) {
    using std::endian;
    std::vector<std::pair<std::string, std::string>> files{
        {"vertex_faces", npy("<i4", "(1, 2)", packed(endian::little, 0, 1))},
        {"vertex_face_toi", npy(">f8", "(1,)", packed(endian::big, 0.5))},
        {"edges", npy("<i8", "(2, 2)", packed(endian::little, 0l, 2l, 1l, 3l), true)},
        {"edge_edges", npy("<u4", "(1, 2)", packed(endian::little, 0u, 1u))},
        {"edge_edge_toi", npy("<f4", "(1,)", packed(endian::little, 0.0f))},
        {"edge_edge_start", npy("|b1", "(1,)", "\1")}};
    ZipWriter archive("test");
    for (auto& [file, bytes] : files) {
        if (file == name) bytes = array;
        if (bytes.empty()) continue;
        archive.begin(file + ".npy", ZipWriter::Method::deflate);
        archive.add(bytes);
        archive.end();
    }
    std::ostringstream out;
    archive.write(out);
    return out.str();
}

TEST(FeatureReading, npz_arrays_can_have_several_byte_orders_and_number_types) {
    const Folder folder;
    const FeatureRow edges{{CandidateKind::edge_edge, {0, 0}, {0, 1, 2, 3}}, 0, true};
    EXPECT_EQ(read_impacts(folder.write("a.npz", npz_with("", ""))).rows, (std::vector{face(0, 1, 0.5, false), edges}));
}

TEST(FeatureReading, malformed_npz_is_an_error) {
    using std::endian;
    const auto bad = [](const char* name, const std::string& array, const std::string& what) {
        expect_bad_rows(npz_with(name, array), "a.npz", what);
    };
    expect_bad_rows("PK", "a.npz", "this is not a .npz archive");
    bad("edges", "", "there is no array \"edges\"");
    bad("edges", "hello, world", "not a NumPy array");
    bad("edges", npy("<i4", "(4,)", packed(endian::little, 0, 1, 2, 3)), "is not of shape (n, 2)");
    bad("edges", npy("<i4", "(1, 3)", packed(endian::little, 0, 1, 2)), "is not of shape (n, 2)");
    bad("edges", npy("<i4", "(2, 2)", packed(endian::little, 0, 1, 2)), "truncated");
    bad("edges", npy("<i4", "(1, 2)", packed(endian::little, 0, 1, 2)), "longer");
    bad("edges", npy("<i4", "(576460752303423487, 2)", ""), "truncated");
    bad("edges", npy("<i4", "(9223372036854775807, 2)", ""), "is not of shape");
    bad("edges", npy("<U4", "(2, 2)", ""), "plain numbers");
    bad("edges", npy("<i4", "(2, 2)", packed(endian::little, 0, 1, 2, -3)), "this is not a valid vertex");
    bad("vertex_face_toi", npy("<f8", "(1, 1)", packed(endian::little, 0.5)), "is not of shape (n,)");
    bad("vertex_face_toi", npy("<f8", "(2,)", packed(endian::little, 0.5, 0.5)), "is not as long");
}

/// Returns the bytes with a few changed, doubled, dropped, inserted or cut off.
std::string mutated(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    constexpr std::string_view pieces[] = {"-",          ":",           ",",     "e",  ".",    "0",   "1",
                                           " ",          "\n",          "[",     "]",  "nan",  "inf", "null",
                                           "2147483647", "99999999999", "1e999", "\"", "\xff", "#"};
    for (std::size_t changes = 1 + below(3); changes > 0 && !bytes.empty(); --changes) {
        const std::size_t place = below(bytes.size()), size = std::min(bytes.size() - place, 1 + below(8));
        switch (below(5)) {
            case 0:
                bytes[place] = static_cast<char>(below(256));
                break;
            case 1:
                bytes.insert(place, bytes.substr(place, size));
                break;
            case 2:
                bytes.erase(place, size);
                break;
            case 3:
                bytes.insert(place, pieces[below(std::size(pieces))]);
                break;
            default:
                bytes.resize(place);
        }
    }
    return bytes;
}

TEST(FeatureReading, randomly_changed_lists_are_read_or_give_an_error) {
    const auto name_of = [](const char* extension) { return std::string("list") + extension; };
    for (const auto& [extension, format] : {std::pair(".txt", PairFormat::txt),
                                            {".csv", PairFormat::csv},
                                            {".json", PairFormat::json},
                                            {".npz", PairFormat::npz}}) {
        for (const bool has_bodies : {false, true}) {
            std::ostringstream out;
            write_impacts(out, example_impacts(has_bodies), format);
            std::mt19937 random(7);
            int lists = 0;
            for (int i = 0; i < 1000; ++i) {
                std::istringstream in(mutated(out.str(), random));
                try {
                    for (const FeatureRow& row : read_impacts(in, name_of(extension)).rows) {
                        ASSERT_TRUE(row.value >= 0 && row.value <= 1) << in.str();
                        for (const std::int32_t id : row.ids) ASSERT_GE(id, 0) << in.str();
                        ASSERT_TRUE(row.bodies.first >= 0 && row.bodies.second >= 0) << in.str();
                        const bool face = row.kind == CandidateKind::vertex_face;
                        ASSERT_TRUE(face || (row.ids[0] < row.ids[1] && row.ids[2] < row.ids[3])) << in.str();
                    }
                    ++lists;
                } catch (const Error& error) {
                    ASSERT_EQ(error.code, ErrorCode::format) << error.what();
                    ASSERT_TRUE(contains(error.what(), name_of(extension))) << error.what();
                    const bool text = format == PairFormat::txt || format == PairFormat::csv;
                    ASSERT_TRUE(!text || error.element == Element::line) << error.what();
                }
            }
            EXPECT_GT(lists, 0) << extension;
            EXPECT_LT(lists, 1000) << extension;
        }
    }
}

TEST(FeatureReading, ground_truth_lists_of_impacts_and_near_pairs_are_read) {
    const auto data = data_folder();
    if (!data || !fs::exists(*data / "gt-motion")) GTEST_SKIP() << "no exact lists";
    const FeatureList list = read_impacts(*data / "gt-motion/motion_cloth-funnel_227_228.txt");
    ASSERT_EQ(list.rows.size(), 134u);
    EXPECT_EQ(list.rows[0], face(8481, 17305, 0.04523222037614761, false));
    EXPECT_EQ(read_near(*data / "gt-motion/prox_cloth-funnel_227.txt").rows.size(), 6270u + 17213u);
}

}  // namespace
}  // namespace crumple::io::test
