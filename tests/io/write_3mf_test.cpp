// Tests of writing 3MF, by reading it back.

#include "3mf_file.h"

#include <sstream>

#include "crumple/detector.h"
#include "files.h"
#include "io/scenes/package.h"

namespace crumple::io::test {
namespace {

/// Returns the text of the model part.
std::string model_text(const fs::path& path) {
    const Source source(path);
    ZipReader archive(source, "3MF");
    EXPECT_TRUE(archive.open("3D/3dmodel.model"));
    std::string text(std::size_t{1} << 20, '\0');
    std::size_t got = 0;
    EXPECT_TRUE(archive.read(text.data(), text.size(), got));
    text.resize(got);
    return text;
}

std::size_t count_of(const std::string& part, const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

/// Returns three bodies, two of one shape; one of the two hits the third.
WorldMesh three_bodies() {
    WorldMesh world;
    world.shapes = {{std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1.1, 1e-300}, {0, 1, 2}},
                    {std::vector<float>{0.1f, -0.0f, -1, 0.25f, 0, 1, 0.125f, 0.5f, 0.5f}, {0, 1, 2}}};
    world.bodies = {{"a", 0},
                    {"a \"quoted\" <name> & \x01 \xff\n", 0, {{1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 1.0 / 3}}},
                    {"b", 1, {{0, -1, 0, 0.25, 1, 0, 0, 0, 0, 0, 1, 0}}}};
    return world;
}

TEST(ThreeMfWriting, mesh_keeps_every_bit) {
    const Folder folder;
    const TriangleMesh doubles{std::vector<double>{0.1, -0.0, 1e308, 5e-324, 1.0 / 3, -7, 1e22, 2, 123456789.125},
                               {0, 1, 2, 2, 1, 1}};
    write_mesh(folder / "a.3mf", doubles);
    expect_same(read_mesh(folder / "a.3mf"), doubles);
    const TriangleMesh floats{std::vector<float>{0.1f, -0.0f, 3e38f, 1e-45f, 1.0f / 3, -7, 1e22f, 2, 16777216},
                              {0, 1, 2}};
    write_mesh(folder / "a.3mf", floats);
    expect_same(read_mesh(folder / "a.3mf", {.precision = Precision::float32}), floats);
    std::ostringstream first, second;
    write_mesh(first, floats, MeshFormat::threemf);
    write_mesh(second, floats, MeshFormat::threemf);
    EXPECT_EQ(first.str(), bytes_of(folder / "a.3mf"));
    EXPECT_EQ(first.str(), second.str());
}

TEST(ThreeMfWriting, world_keeps_bodies_and_shared_shapes) {
    const Folder folder;
    const WorldMesh world = three_bodies();
    write_world(folder / "a.3mf", world);
    const WorldMesh read = read_world(folder / "a.3mf");
    EXPECT_TRUE(read.warnings.empty());
    ASSERT_EQ(read.bodies.size(), 3u);
    ASSERT_EQ(read.shapes.size(), 2u);
    expect_same(read.shapes[0], world.shapes[0]);
    for (std::size_t b = 0; b < 3; ++b) {
        EXPECT_EQ(read.bodies[b].shape, world.bodies[b].shape);
        EXPECT_EQ(read.bodies[b].pose, world.bodies[b].pose);
    }
    EXPECT_EQ(read.bodies[0].name, "a");
    EXPECT_EQ(read.bodies[1].name, "a \"quoted\" <name> & \xef\xbf\xbd \xef\xbf\xbd\n");
    EXPECT_EQ(read.bodies[2].name, "b");
    std::ostringstream out;
    write_world(out, world);
    EXPECT_EQ(out.str(), bytes_of(folder / "a.3mf"));
    EXPECT_EQ(error_of([&] { write_world(folder / "a.ply", world); }).code, ErrorCode::invalid_argument);
    EXPECT_FALSE(fs::exists(folder / "a.ply"));
}

TEST(ThreeMfWriting, colliding_triangles_are_coloured) {
    const Folder folder;
    Detector detector;
    const TriangleMesh crossing{
        std::vector<double>{0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, -1, 1, 1, 1, 2, 1, 1, 9, 9, 9, 9, 9, 8, 9, 8, 9},
        {0, 1, 2, 6, 7, 8, 3, 4, 5}};
    write_coloured(folder / "a.3mf", crossing, nullptr, detector.find(crossing.view()));
    expect_same(read_mesh(folder / "a.3mf"), crossing);
    const std::string text = model_text(folder / "a.3mf");
    EXPECT_TRUE(contains(text, "displaycolor=\"#B2B2B2\"") && contains(text, "displaycolor=\"#D55E00\"")) << text;
    EXPECT_TRUE(contains(text, "v1=\"0\" v2=\"1\" v3=\"2\" pid=\"1\" p1=\"1\"/>")) << text;
    EXPECT_TRUE(contains(text, "v1=\"6\" v2=\"7\" v3=\"8\"/>")) << text;
    EXPECT_EQ(count_of("p1=\"1\"", text), 2u);
}

TEST(ThreeMfWriting, coloured_world_shares_shapes_of_free_bodies) {
    const Folder folder;
    WorldMesh world = three_bodies();
    world.bodies.push_back({"far", 0, {{1, 0, 0, 100, 0, 1, 0, 100, 0, 0, 1, 100}}});
    Detector detector;
    const WorldView view = world.view();
    const Intersections& found = detector.find(view.world(), {.index = true});
    ASSERT_EQ(found.pairs.size(), 1u);
    write_coloured(folder / "a.3mf", world, found);
    const WorldMesh read = read_world(folder / "a.3mf");
    ASSERT_EQ(read.bodies.size(), 4u);
    EXPECT_EQ(read.bodies[1].shape, read.bodies[3].shape);
    EXPECT_NE(read.bodies[0].shape, read.bodies[1].shape);
    for (std::size_t b = 0; b < 4; ++b) EXPECT_EQ(read.bodies[b].pose, world.bodies[b].pose);
    EXPECT_EQ(count_of("p1=\"1\"", model_text(folder / "a.3mf")), 2u);
}

TEST(ThreeMfWriting, empty_world_and_mesh_can_be_written) {
    const Folder folder;
    write_world(folder / "a.3mf", {});
    EXPECT_EQ(read_world(folder / "a.3mf").bodies.size(), 0u);
    write_mesh(folder / "b.3mf", {});
    EXPECT_EQ(read_mesh(folder / "b.3mf").triangle_count(), 0);
}

}  // namespace
}  // namespace crumple::io::test
