// Tests of worlds that own their arrays: from files of one mesh, as views for a detector, as one mesh.

#include <cmath>

#include "crumple/detector.h"
#include "samples.h"
#include "scenes.h"

namespace crumple::io::test {
namespace {

WorldMesh robot() { return read_scene(crumple::test::robot_scene()); }

TEST(WorldMesh, mesh_file_is_a_world_of_one_body) {
    const Folder folder;
    for (const Sample& sample : samples()) {
        const fs::path path = folder.write(sample.name, sample.bytes);
        const WorldMesh world = read_world(path);
        ASSERT_EQ(world.bodies.size(), 1u);
        EXPECT_EQ(world.bodies[0].name, path.stem());
        EXPECT_EQ(world.bodies[0].pose, Pose());
        expect_same(world.shapes[0], read_mesh(path));
    }
    EXPECT_EQ(read_world(folder.write("odd.obj", "v 0 0 0\n")).warnings.size(), 1u);
    expect_same(read_world(folder / "little.ply", {.group_property = "part"}).shapes[0],
                read_mesh(folder / "little.ply", {.group_property = "part"}));
}

TEST(WorldMesh, view_can_be_passed_to_a_detector) {
    const WorldMesh world = robot();
    const WorldView view = world.view(), named = world.view(7);
    EXPECT_EQ(view.shapes[0].name, 0u);
    EXPECT_EQ(named.shapes[0].name, 7u);
    Detector detector;
    IntersectionQuery query;
    query.output = Output::body_pairs;
    query.filter.bodies = PairScope::between;
    for (const WorldView* const v : {&view, &named, &named}) {
        const Array<BodyPair>& found = detector.find(v->world(), query).bodies;
        EXPECT_EQ(std::vector<BodyPair>(found.begin(), found.end()), (std::vector<BodyPair>{{0, 1}, {1, 2}}));
    }
}

TEST(WorldMesh, search_of_the_posed_mesh_finds_the_pairs_of_the_world) {
    WorldMesh world = robot();
    // Coordinates that float32 must round.
    world.bodies[2].pose.rows = {0.1, 0.7, 0.3, 1.2, 0.9, 0.1, 0.2, 0.1, 0.3, 0.2, 0.8, 0.125};
    const TriangleMesh mesh = posed_mesh(world);
    EXPECT_EQ(mesh.triangle_count(), 16);
    EXPECT_EQ(mesh.groups, (std::vector<std::int32_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3}));
    EXPECT_EQ(mesh.precision(), ScalarType::float32);
    EXPECT_EQ(coordinates(mesh)[3 * 9], static_cast<float>(0.1 + 1.2));

    Detector of_worlds, of_meshes;
    const WorldView view = world.view();
    const Intersections& by_body = of_worlds.find(view.world());
    const Intersections& joined = of_meshes.find(mesh.view());
    ASSERT_EQ(by_body.pairs.size(), joined.pairs.size());
    for (std::size_t i = 0; i < joined.pairs.size(); ++i) {
        EXPECT_EQ(4 * by_body.bodies[i].first + by_body.pairs[i].a, joined.pairs[i].a);
        EXPECT_EQ(4 * by_body.bodies[i].second + by_body.pairs[i].b, joined.pairs[i].b);
    }

    world.bodies[1].pose.rows[4] = std::nan("");
    EXPECT_EQ(error_of([&] { posed_mesh(world); }).index, 1);
    world.bodies[0].shape = 1;
    EXPECT_EQ(error_of([&] { posed_mesh(world); }).element, Element::body);
}

const Intersections& find_indexed(Detector& detector, const WorldMesh& world) {
    IntersectionQuery query;
    query.filter.bodies = PairScope::between;
    query.index = true;
    return detector.find(world.view().world(), query);
}

TEST(ColouredWorld, glb_keeps_bodies_and_shared_shapes) {
    WorldMesh world = robot();
    world.bodies[3].name = "\xff";
    world.bodies.push_back({"also far", 0, {{0.1, 0.7, 0.3, 99, 0.9, 0.1, 0.2, 99, 0.3, 0.2, 0.8, 99}}});
    Detector detector;
    const Intersections& found = find_indexed(detector, world);
    const Folder folder;
    write_coloured(folder / "c.glb", world, found);
    std::ostringstream out;
    write_coloured(out, world, found, MeshFormat::glb);
    EXPECT_EQ(out.str(), bytes_of(folder / "c.glb"));

    const WorldMesh again = read_world(folder / "c.glb", {.weld = Weld::no});
    ASSERT_EQ(again.bodies.size(), world.bodies.size());
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        EXPECT_EQ(again.bodies[b].name, b == 3 ? "\xef\xbf\xbd" : world.bodies[b].name);  // the replacement character
        EXPECT_EQ(again.bodies[b].pose, world.bodies[b].pose);
        EXPECT_EQ(coordinates(again.shapes[static_cast<std::size_t>(again.bodies[b].shape)]),
                  coordinates(world.shapes[0]));
    }
    EXPECT_EQ(again.bodies[3].shape, again.bodies[4].shape) << "of bodies that are free";
    EXPECT_NE(again.bodies[3].shape, again.bodies[1].shape);
}

TEST(ColouredWorld, glb_keeps_distant_float64_vertices_to_within_1e_8) {
    WorldMesh world;
    world.shapes.push_back({std::vector<double>{1e6, 0, 0, 1e6 + 0.1, 0, 0, 1e6, 0.1, 0}, {0, 1, 2}});
    world.bodies.push_back({"a", 0, {{0, 1, 0, 0, -1, 0, 0, 1e6, 0, 0, 1, 0}}});
    Detector detector;
    const Folder folder;
    write_coloured(folder / "c.glb", world, find_indexed(detector, world));
    WorldMesh again = read_world(folder / "c.glb", {.precision = Precision::float64});
    const std::vector<double> found = coordinates(posed_mesh(again)), expected = coordinates(posed_mesh(world));
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-8);
}

TEST(ColouredWorld, ply_holds_the_posed_mesh_and_html_counts_its_triangles) {
    const WorldMesh world = robot();
    Detector detector;
    const Intersections& found = find_indexed(detector, world);
    const Folder folder;
    for (const char* const name : {"c.ply", "c.obj", "c.html"}) write_coloured(folder / name, world, found);
    expect_same(read_mesh(folder / "c.ply", {.group_property = "group"}), posed_mesh(world));
    EXPECT_TRUE(contains(bytes_of(folder / "c.html"), "colliding pairs of 16 triangles"));
    EXPECT_EQ(error_of([&] { write_coloured(folder / "c.stl", world, found); }).code, ErrorCode::invalid_argument);
}

TEST(ColouredWorld, collisions_of_another_world_are_refused) {
    WorldMesh world = robot();
    Detector detector;
    const Intersections& found = find_indexed(detector, world);
    const Folder folder;
    world.bodies.pop_back();
    EXPECT_EQ(error_of([&] { write_coloured(folder / "c.glb", world, found); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { write_coloured(folder / "c.glb", robot(), Intersections()); }).code,
              ErrorCode::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace crumple::io::test
