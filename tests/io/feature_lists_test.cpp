// Tests of lists of impacts and of near pairs: writing them, and reading them back.

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "feature_results.h"
#include "files.h"

namespace crumple::io::test {
namespace {

std::string written(const Impacts& impacts, PairFormat format) {
    std::ostringstream out;
    write_impacts(out, impacts, format);
    return out.str();
}
std::string written(const Proximities& nearby, PairFormat format) {
    std::ostringstream out;
    write_near(out, nearby, format);
    return out.str();
}

TEST(FeatureLists, text_has_one_line_per_pair_of_features) {
    EXPECT_EQ(written(example_impacts(), PairFormat::txt), "vf 7 1 0.1 0\nvf 9 0 1 0\nee 0 7 2 9 0 1\n");
    EXPECT_EQ(written(example_impacts(), PairFormat::automatic), written(example_impacts(), PairFormat::txt));
    EXPECT_EQ(written(example_near(), PairFormat::txt), "vf 7 1 5e-324\nvf 9 0 inf\nee 0 7 2 9 0\n");
    EXPECT_EQ(written(Impacts(), PairFormat::txt), "");
}

TEST(FeatureLists, ids_of_several_bodies_name_the_body) {
    EXPECT_EQ(written(example_impacts(true), PairFormat::txt),
              "vf 0:7 1:1 0.1 0\nvf 1:9 0:0 1 0\nee 0:0 0:7 1:2 1:9 0 1\n");
    EXPECT_EQ(written(example_near(true), PairFormat::csv),
              "kind,vertex,face,a,b,c,d,squared_distance,touching\nvf,0:7,1:1,,,,,5e-324,0\nvf,1:9,0:0,,,,,inf,0\n"
              "ee,,,0:0,0:7,1:2,1:9,0,1\n");
}

TEST(FeatureLists, csv_has_named_columns) {
    EXPECT_EQ(written(example_impacts(), PairFormat::csv),
              "kind,vertex,face,a,b,c,d,toi,start\nvf,7,1,,,,,0.1,0\nvf,9,0,,,,,1,0\nee,,,0,7,2,9,0,1\n");
}

TEST(FeatureLists, list_written_in_blocks_has_the_rows_of_its_blocks) {
    const auto expect = [](const auto& block, ListKind of) {
        for (const PairFormat format : {PairFormat::txt, PairFormat::csv, PairFormat::automatic}) {
            std::ostringstream twice;
            FeatureWriter writer(twice, of, format);
            writer.add(block);
            writer.add(block);
            writer.commit();
            const std::string once = written(block, format);
            EXPECT_EQ(twice.str(), once + once.substr(format == PairFormat::csv ? once.find('\n') + 1 : 0));
        }
    };
    for (const bool has_bodies : {false, true}) {
        expect(example_impacts(has_bodies), ListKind::impacts);
        expect(example_near(has_bodies), ListKind::near);
    }
}

TEST(FeatureLists, blocks_replace_the_old_file_only_on_commit) {
    const Folder folder;
    const auto path = folder / "near.csv";
    std::ofstream(path) << "old";
    FeatureWriter(path, ListKind::near).add(example_near());
    EXPECT_EQ(bytes_of(path), "old");
    FeatureWriter writer(path, ListKind::near);
    writer.add(example_near());
    EXPECT_EQ(error_of([&] { writer.add(example_impacts()); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { writer.add(Candidates()); }).code, ErrorCode::invalid_argument);
    writer.commit();
    EXPECT_EQ(bytes_of(path), written(example_near(), PairFormat::csv));
    for (const char* const name : {"a.json", "a.npz", "a.xyz"}) {
        const Error error = error_of([&] { FeatureWriter(folder / name, ListKind::candidates); });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_STREQ(error.what(), "candidates are written block by block as .txt or .csv");
    }
}

TEST(FeatureLists, json_has_named_arrays) {
    using nlohmann::json;
    const auto impacts = json::parse(written(example_impacts(), PairFormat::json));
    EXPECT_EQ(impacts["vertex_faces"], json::parse("[[7,1],[9,0]]"));
    EXPECT_EQ(impacts["vertex_face_toi"], json::parse("[0.1,1]"));
    EXPECT_EQ(impacts["vertex_face_start"], json::parse("[0,0]"));
    EXPECT_EQ(impacts["edges"], json::parse("[[0,1],[0,7],[2,9]]"));
    EXPECT_EQ(impacts["edge_edges"], json::parse("[[1,2]]"));
    EXPECT_EQ(impacts["edge_edge_toi"], json::parse("[0]"));
    EXPECT_EQ(impacts["edge_edge_start"], json::parse("[1]"));
    EXPECT_EQ(impacts["earliest"], json::parse(R"({"kind":"edge_edge","pair":[1,2],"toi":0,"start":1})"));
    EXPECT_EQ(impacts["statistics"]["pairs"], 3);
    EXPECT_FALSE(impacts.contains("first_edge"));
    EXPECT_TRUE(json::parse(written(Impacts(), PairFormat::json))["earliest"].is_null());

    const auto near = json::parse(written(example_near(true), PairFormat::json));
    EXPECT_EQ(near["vertex_face_bodies"], json::parse("[[0,1],[1,0]]"));
    EXPECT_EQ(near["edge_edge_bodies"], json::parse("[[0,1]]"));
    EXPECT_EQ(near["first_edge"], json::parse("[0,2,5]"));
    EXPECT_EQ(near["vertex_face_squared_distance"], json::parse("[5e-324,null]"));
    EXPECT_EQ(near["edge_edge_touching"], json::parse("[1]"));
    EXPECT_FALSE(near.contains("earliest"));
}

TEST(FeatureLists, every_format_reads_back_what_was_written) {
    const Folder folder;
    for (const char* const name : {"a.txt", "a.csv", "a.json", "a.npz", "A.CSV"}) {
        for (const bool has_bodies : {false, true}) {
            write_impacts(folder / name, example_impacts(has_bodies));
            const FeatureList impacts = read_impacts(folder / name);
            EXPECT_EQ(impacts.rows, list_of(example_impacts(has_bodies)).rows) << name;
            EXPECT_EQ(impacts.has_bodies, has_bodies) << name;
            write_near(folder / name, example_near(has_bodies));
            EXPECT_EQ(read_near(folder / name).rows, list_of(example_near(has_bodies)).rows) << name;
        }
        write_impacts(folder / name, {});
        EXPECT_TRUE(read_impacts(folder / name).rows.empty()) << name;
    }
}

/// Returns impacts with codimensional edges and points, of one body or of two bodies. The second body has no
/// codimensional points.
Impacts example_rods(bool has_bodies) {
    Impacts a = example_impacts(has_bodies);
    a.edges[1] = {7, 0};  // codimensional, in the order of the caller
    a.points = array<std::int32_t>({0, 0, 0, 0, 0, 0, 0, 17, 18, 19});
    a.first_point = array<std::int64_t>({0, 10});
    if (has_bodies) a.first_point.push_back(10);
    const auto set = [&](FeatureKind kind, Pair pair, BodyPair bodies) {
        add(a[kind], pair, bodies, has_bodies);
        a[kind].toi.push_back(0.25);
        a[kind].start.push_back(0);
    };
    set(FeatureKind::vertex_edge, {9, 1}, {0, 0});
    set(FeatureKind::vertex_vertex, {7, 8}, {0, has_bodies ? 1 : 0});
    return a;
}

TEST(FeatureLists, triangle_pairs_are_written_with_impacts_or_alone) {
    const Folder folder;
    for (const bool has_bodies : {false, true}) {
        Impacts impacts = example_rods(has_bodies);
        impacts.lists_triangle_pairs = true;
        const auto with = [&](auto write, PairFormat format) {
            std::ostringstream out;
            write(out, impacts, format);
            return out.str();
        };
        const auto all = [](auto& out, const Impacts& i, PairFormat format) { write_impacts(out, i, format); };
        const auto alone = [](auto& out, const Impacts& i, PairFormat format) { write_triangle_pairs(out, i, format); };
        EXPECT_EQ(with(alone, PairFormat::txt), "");
        EXPECT_TRUE(nlohmann::json::parse(with(all, PairFormat::json)).contains("face_faces")) << "be there none";
        add(impacts.triangle_pairs, {4, 5}, {0, has_bodies ? 1 : 0}, has_bodies);
        impacts.triangle_pairs.toi.push_back(0.5);
        impacts.triangle_pairs.start.push_back(0);
        const std::string line = has_bodies ? "ff 0:4 1:5 0.5 0\n" : "ff 4 5 0.5 0\n";
        EXPECT_EQ(with(alone, PairFormat::txt), line);
        EXPECT_EQ(with(all, PairFormat::txt).find(line) != std::string::npos, true);
        const auto json = nlohmann::json::parse(with(alone, PairFormat::json));
        EXPECT_EQ(json["face_faces"], nlohmann::json::parse("[[4,5]]"));
        for (const char* const absent : {"vertex_faces", "edges", "edge_edges", "earliest"})
            EXPECT_FALSE(json.contains(absent)) << absent;
        for (const char* const name : {"a.txt", "a.csv", "a.json", "a.npz"}) {
            write_impacts(folder / name, impacts);
            EXPECT_EQ(read_impacts(folder / name).rows, list_of(impacts).rows) << name;
            write_triangle_pairs(folder / name, impacts);
            const FeatureList pairs = read_impacts(folder / name);
            ASSERT_EQ(pairs.rows.size(), 1U) << name;
            EXPECT_EQ(pairs.rows[0], list_of(impacts).rows[list_of(impacts).rows.size() - 3]) << "before ve and vv";
        }
        impacts.triangle_pairs.toi.clear();
        EXPECT_EQ(error_of([&] { list_of(impacts); }).code, ErrorCode::invalid_argument);
    }
}

TEST(FeatureLists, codimensional_features_are_named_by_their_vertices) {
    const auto text = [](bool has_bodies, PairFormat format) {
        std::ostringstream out;
        write_impacts(out, example_rods(has_bodies), format);
        return out.str();
    };
    EXPECT_EQ(text(false, PairFormat::txt),
              "vf 17 1 0.1 0\nvf 19 0 1 0\nee 0 7 2 9 0 1\nve 19 0 7 0.25 0\nvv 17 18 0.25 0\n");
    EXPECT_EQ(text(true, PairFormat::txt),
              "vf 0:17 1:1 0.1 0\nvf 1:9 0:0 1 0\nee 0:0 0:7 1:2 1:9 0 1\nve 0:19 0:0 0:7 0.25 0\n"
              "vv 0:17 1:8 0.25 0\n");
    EXPECT_EQ(text(false, PairFormat::csv),
              "kind,vertex,face,a,b,c,d,toi,start\nvf,17,1,,,,,0.1,0\nvf,19,0,,,,,1,0\nee,,,0,7,2,9,0,1\n"
              "ve,19,,0,7,,,0.25,0\nvv,17,,18,,,,0.25,0\n");
    const auto json = nlohmann::json::parse(text(true, PairFormat::json));
    EXPECT_EQ(json["vertex_edges"], nlohmann::json::parse("[[19,1]]"));
    EXPECT_EQ(json["vertex_vertices"], nlohmann::json::parse("[[17,8]]"));
    EXPECT_EQ(json["vertex_vertex_bodies"], nlohmann::json::parse("[[0,1]]"));
    EXPECT_EQ(json["vertex_edge_toi"], nlohmann::json::parse("[0.25]"));
    EXPECT_EQ(json["vertex_faces"], nlohmann::json::parse("[[17,1],[9,0]]"));
    const Folder folder;
    for (const char* const name : {"a.txt", "a.csv", "a.json", "a.npz"})
        for (const bool has_bodies : {false, true}) {
            write_impacts(folder / name, example_rods(has_bodies));
            EXPECT_EQ(read_impacts(folder / name).rows, list_of(example_rods(has_bodies)).rows) << name;
        }
    for (const std::int32_t point : {-1, 10}) {
        Impacts impacts = example_rods(false);
        impacts[FeatureKind::vertex_vertex].pairs[0].b = point;
        EXPECT_EQ(error_of([&] { list_of(impacts); }).code, ErrorCode::invalid_argument);
        impacts = example_rods(false);
        impacts[FeatureKind::vertex_edge].pairs[0] = {0, point};
        EXPECT_EQ(error_of([&] { list_of(impacts); }).code, ErrorCode::invalid_argument);
    }
}

TEST(FeatureLists, inconsistent_lists_are_refused) {
    const Folder folder;
    const auto refused = [&](const Impacts& impacts) {
        EXPECT_EQ(error_of([&] { write_impacts(folder / "a.txt", impacts); }).code, ErrorCode::invalid_argument);
        EXPECT_FALSE(fs::exists(folder / "a.txt"));
    };
    Impacts impacts = example_impacts();
    impacts[FeatureKind::vertex_face].toi.push_back(1);
    refused(impacts);
    impacts = example_impacts();
    impacts[FeatureKind::edge_edge].start = {};
    refused(impacts);
    for (const std::int32_t edge : {-1, 3}) {
        impacts = example_impacts();
        impacts[FeatureKind::edge_edge].pairs[0].b = edge;
        refused(impacts);
    }
    impacts = example_impacts(true);
    impacts[FeatureKind::vertex_face].bodies = {};
    refused(impacts);
    for (const std::int32_t body : {-1, 2}) {
        impacts = example_impacts(true);
        impacts[FeatureKind::edge_edge].bodies[0].second = body;
        refused(impacts);
    }
    EXPECT_EQ(error_of([&] { write_near(folder / "a.ply", example_near()); }).code, ErrorCode::invalid_argument);
}

TEST(FeatureLists, failing_stream_is_an_error) {
    for (const PairFormat format : {PairFormat::txt, PairFormat::csv, PairFormat::json, PairFormat::npz}) {
        std::ofstream closed;
        EXPECT_EQ(error_of([&] { write_impacts(closed, example_impacts(), format); }).code, ErrorCode::file);
        EXPECT_EQ(error_of([&] { write_near(closed, example_near(), format); }).code, ErrorCode::file);
    }
}

// Returns a square of triangles 0 and 1, and a separate triangle 2.
TriangleMesh three_triangles() {
    return {std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 9, 9, 9, 9, 8, 9, 8, 9, 9},
            {0, 1, 2, 0, 2, 3, 4, 5, 6}};
}

using Corners = std::vector<std::uint32_t>;

/// Returns the corners of the triangles of each material in the only mesh.
std::map<std::string, Corners> triangles_of(const std::string& glb) {
    const auto length = load<std::uint32_t>(glb.data() + 12, std::endian::little);
    const auto description = nlohmann::json::parse(glb.substr(20, length));
    const char* const binary = glb.data() + 20 + length + 8;
    std::map<std::string, Corners> result;
    for (const auto& primitive : description["meshes"][0]["primitives"]) {
        const auto& indices = description["accessors"][primitive["indices"].get<std::size_t>()];
        const auto& material = description["materials"][primitive["material"].get<std::size_t>()];
        const auto& view = description["bufferViews"][indices["bufferView"].get<std::size_t>()];
        const char* const first =
            binary + view.value("byteOffset", std::size_t{0}) + indices.value("byteOffset", std::size_t{0});
        Corners& corners = result[material["name"]];
        for (std::size_t i = 0; i < indices["count"].get<std::size_t>(); ++i)
            corners.push_back(load<std::uint32_t>(first + 4 * i, std::endian::little));
    }
    return result;
}

TEST(FeatureLists, impacts_colour_the_triangles_they_hit) {
    Impacts impacts;
    impacts[FeatureKind::vertex_face].pairs = array<Pair>({{3, 2}});  // vertex 3 is of triangle 1
    impacts[FeatureKind::vertex_face].toi = array({0.5});
    impacts[FeatureKind::vertex_face].start = array<std::uint8_t>({0});
    const auto colours = [&] {
        std::ostringstream out;
        write_coloured(out, three_triangles(), impacts);
        return triangles_of(out.str());
    };
    EXPECT_EQ(colours(), (std::map<std::string, Corners>{{"free", {0, 1, 2}}, {"shade 5", {0, 2, 3, 4, 5, 6}}}));

    impacts[FeatureKind::edge_edge].pairs = array<Pair>({{0, 1}});  // the first edge is of triangle 0
    impacts[FeatureKind::edge_edge].toi = array({0.0});
    impacts[FeatureKind::edge_edge].start = array<std::uint8_t>({1});
    impacts.edges = array<Edge>({{0, 1}, {4, 5}});
    impacts.first_edge = array<std::int64_t>({0, 2});
    EXPECT_EQ(colours(), (std::map<std::string, Corners>{{"shade 1", {0, 1, 2, 4, 5, 6}}, {"shade 5", {0, 2, 3}}}));

    impacts[FeatureKind::vertex_face].toi[0] = 1;
    EXPECT_EQ(colours(), (std::map<std::string, Corners>{{"shade 1", {0, 1, 2, 4, 5, 6}}, {"shade 8", {0, 2, 3}}}));
    impacts[FeatureKind::vertex_face].pairs[0].b = 3;
    EXPECT_EQ(error_of(colours).code, ErrorCode::invalid_argument) << "there is no such face";
}

TEST(FeatureLists, near_pairs_shade_triangles_of_both_meshes_by_distance) {
    Proximities nearby;
    nearby[FeatureKind::vertex_face].pairs = array<Pair>({{3, 2}, {4, 0}});
    nearby[FeatureKind::vertex_face].bodies = array<BodyPair>({{0, 1}, {1, 0}});
    nearby[FeatureKind::vertex_face].squared_distance = array({1.0, 16.0});
    nearby[FeatureKind::vertex_face].touching = array<std::uint8_t>({0, 0});
    const TriangleMesh mesh = three_triangles();
    std::ostringstream out;
    write_coloured(out, mesh, &mesh, nearby);
    // Near pairs colour triangles 1 (distance 1) and 0 (distance 4) of the first mesh, and 2 (distance 1) of the
    // second, whose vertices are numbered from 7 on.
    EXPECT_EQ(triangles_of(out.str()),
              (std::map<std::string, Corners>{
                  {"free", {4, 5, 6, 7, 8, 9, 7, 9, 10}}, {"shade 3", {0, 2, 3, 11, 12, 13}}, {"shade 8", {0, 1, 2}}}));
    EXPECT_EQ(error_of([&] { write_coloured(out, mesh, nullptr, nearby); }).code, ErrorCode::invalid_argument);
    const Folder folder;
    EXPECT_EQ(error_of([&] { write_coloured(folder / "a.ply", mesh, &mesh, nearby); }).code,
              ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace crumple::io::test
