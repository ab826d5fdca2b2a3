// Tests of reading glTF scenes as worlds of bodies.

#include "scenes.h"

namespace crumple::io::test {
namespace {

using Json = nlohmann::json;

std::vector<std::string> names_of(const WorldMesh& world) {
    std::vector<std::string> names;
    for (const NamedBody& body : world.bodies) names.push_back(body.name);
    return names;
}

using Names = std::vector<std::string>;
using Rows = std::array<double, 12>;

TEST(Gltf, nodes_with_meshes_are_bodies_that_share_shapes) {
    const WorldMesh world = read_scene(crumple::test::robot_scene());
    EXPECT_EQ(names_of(world), (Names{"base", "arm", "hand", "far away"}));
    ASSERT_EQ(world.shapes.size(), 1u);
    EXPECT_EQ(world.shapes[0].precision(), ScalarType::float32);
    EXPECT_EQ(world.shapes[0].triangles, (std::vector<std::int32_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
    EXPECT_EQ(coordinates(world.shapes[0]), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}));
    EXPECT_EQ(world.bodies[2].pose.rows, (Rows{1, 0, 0, 1.25, 0, 1, 0, 0.125, 0, 0, 1, 0.125}));
    EXPECT_EQ(world.triangle_count(), 16);
    EXPECT_TRUE(world.warnings.empty());
}

TEST(Gltf, buffer_can_be_embedded_or_a_separate_file) {
    const GltfScene scene = crumple::test::robot_scene();
    const WorldMesh expected = read_scene(scene);
    const Folder folder;
    folder.write("a b.bin", scene.bytes);
    const auto expect_read = [&](const std::string& uri) {
        const WorldMesh world = read_world(folder.write("a.gltf", scene.gltf(uri)));
        ASSERT_EQ(world.bodies.size(), 4u) << uri;
        expect_same(world.shapes[0], expected.shapes[0]);
    };
    expect_read("a%20b.bin");
    std::string base64;
    const char* const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < scene.bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < scene.bytes.size() ? static_cast<unsigned char>(scene.bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            base64 += i + k > scene.bytes.size() ? '=' : letters[bits >> (18 - 6 * k) & 63];
    }
    expect_read("data:application/octet-stream;base64," + base64);
    for (const char* const uri : {"none.bin", "/dev/zero", "http://example.org/a.bin", "", "data:,abc",
                                  "data:application/octet-stream;base64,A*BC", "data:x;base64,AAAA"})
        error_of([&] { read_world(folder.write("a.gltf", scene.gltf(uri))); });
}

TEST(Gltf, stream_that_names_a_separate_buffer_file_is_refused) {
    const GltfScene scene = crumple::test::robot_scene();
    std::istringstream glb(scene.glb()), gltf(scene.gltf("a.bin"));
    EXPECT_EQ(read_world(glb, "standard input").bodies.size(), 4u);
    const Error error = error_of([&] { read_world(gltf, "standard input"); });
    EXPECT_NE(std::string(error.what()).find("a stream has no files beside it"), std::string::npos) << error.what();
}

TEST(Gltf, poses_compose_along_parent_nodes) {
    GltfScene scene;
    const int shape = scene.add_tetrahedron();
    const int leaf = scene.add_node({{"name", "leaf"}, {"mesh", shape}, {"scale", {2, 4, -1}}}, false);
    const int middle = scene.add_node(
        // Column by column: maps x to y and y to -x, then translates.
        {{"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}, {"children", {leaf}}}, false);
    // A quaternion in float32: a quarter turn about z.
    const double half = 0.70710677;
    scene.add_node({{"rotation", {0, 0, half, half}}, {"translation", {1, 2, 3}}, {"children", {middle}}});
    const WorldMesh world = read_scene(scene);
    ASSERT_EQ(names_of(world), Names{"leaf"});
    EXPECT_EQ(world.bodies[0].pose.rows, (Rows{-2, 0, 0, -19, 0, -4, 0, 12, 0, 0, -1, 33}));
}

TEST(Gltf, bodies_are_the_nodes_with_meshes_of_the_scene_in_file_order) {
    GltfScene scene;
    const int shape = scene.add_tetrahedron();
    const int child = scene.add_node({{"name", "child"}, {"mesh", shape}}, false);
    scene.add_node({{"name", "alone"}, {"mesh", shape}}, false);
    scene.add_node({{"name", "camera"}, {"camera", 0}});
    scene.add_node({{"name", "parent"}, {"mesh", shape}, {"children", {child}}});
    WorldMesh world = read_scene(scene);
    EXPECT_EQ(names_of(world), (Names{"child", "parent"}));
    ASSERT_EQ(world.warnings.size(), 1u);
    EXPECT_TRUE(world.warnings[0].ends_with("a.glb: 1 of its nodes with meshes are not in the scene"));

    scene.json["scenes"].push_back({{"nodes", {1}}});
    scene.json["scene"] = 1;
    EXPECT_EQ(names_of(read_scene(scene)), Names{"alone"});
    scene.json.erase("scene");
    EXPECT_EQ(names_of(read_scene(scene)), (Names{"child", "parent"}));
    scene.json.erase("scenes");
    EXPECT_EQ(names_of(read_scene(scene)), (Names{"child", "alone", "parent"}));
    scene.json["nodes"] = Json::array();
    EXPECT_TRUE(read_scene(scene).warnings[0].ends_with("it holds no bodies"));
    EXPECT_EQ(error_of([&] { read_scene(scene, {.strict = true}); }).code, ErrorCode::format);
}

TEST(Gltf, every_body_has_a_unique_name) {
    GltfScene scene;
    const int shape = scene.add_tetrahedron(), named = scene.add_tetrahedron();
    scene.json["meshes"].at(static_cast<std::size_t>(named))["name"] = "wheel";
    for (const char* const name : {"leg", "leg", "leg_2", "leg",
                                   "Kn\xc3\xb6"
                                   "chel"})
        scene.add_body(name, shape);
    for (int i = 0; i < 2; ++i) scene.add_node({{"mesh", named}});
    scene.add_node({{"mesh", shape}});
    EXPECT_EQ(names_of(read_scene(scene)), (Names{"leg", "leg_3", "leg_2", "leg_4",
                                                  "Kn\xc3\xb6"
                                                  "chel",
                                                  "wheel", "wheel_2", "node7"}));
}

TEST(Gltf, primitives_of_a_mesh_are_one_shape) {
    GltfScene scene;
    const int square = scene.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}),
              other = scene.add_positions({0, 0, 5, 1, 0, 5, 0, 1, 5});
    const int strip = scene.add_indices({0, 1, 2, 3}),
              bytes = scene.add_accessor<std::uint8_t>({0, 1, 3}, 5121, "SCALAR"),
              words = scene.add_accessor<std::uint32_t>({0, 1, 3, 2}, 5125, "SCALAR");
    const auto primitive = [](int positions, int indices, int mode) {
        Json result = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
        if (indices >= 0) result["indices"] = indices;
        return result;
    };
    scene.add_body("a",
                   scene.add_mesh({primitive(square, strip, 5), primitive(other, -1, 4), primitive(square, bytes, 4),
                                   primitive(square, words, 6), primitive(square, strip, 1)}));
    const WorldMesh world = read_scene(scene, {.weld = Weld::no});
    EXPECT_EQ(world.shapes[0].vertex_count(), 7);
    EXPECT_EQ(world.shapes[0].triangles,
              (std::vector<std::int32_t>{0, 1, 2, 1, 3, 2, 4, 5, 6, 0, 1, 3, 0, 1, 3, 0, 3, 2}));
    ASSERT_EQ(world.warnings.size(), 1u);
    EXPECT_TRUE(contains(world.warnings[0], "meshes[0].primitives[4] holds points or lines, which are skipped"));
}

TEST(Gltf, degenerate_triangles_that_join_strips_are_skipped) {
    GltfScene scene;
    const int positions = scene.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0});
    const int strip = scene.add_indices({0, 1, 2, 2, 3, 3, 4, 5});
    scene.add_body("a", scene.add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", strip}, {"mode", 5}}}));
    EXPECT_EQ(read_scene(scene).shapes[0].triangles, (std::vector<std::int32_t>{0, 1, 2, 3, 5, 4}));
}

TEST(Gltf, vertices_are_welded_by_default) {
    GltfScene scene;
    scene.add_body("a", scene.add_mesh({0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0f, 0, 0, 1, 0, 0, 0, 0, 1}, {0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(read_scene(scene).shapes[0].triangles, (std::vector<std::int32_t>{0, 1, 2, 0, 1, 3}));
    EXPECT_EQ(read_scene(scene, {.weld = Weld::no}).shapes[0].vertex_count(), 6);
}

TEST(Gltf, meshes_over_the_same_data_are_one_shape) {
    GltfScene scene;
    const int red = scene.add_tetrahedron();
    scene.json["meshes"].push_back(scene.json["meshes"].at(static_cast<std::size_t>(red)));
    scene.json["meshes"].at(static_cast<std::size_t>(red))["primitives"][0]["material"] = 0;
    scene.add_body("red", red);
    scene.add_body("green", red + 1);
    EXPECT_EQ(read_scene(scene).shapes.size(), 1u);
}

TEST(Gltf, shape_has_only_its_vertices_of_a_shared_accessor) {
    GltfScene scene;
    std::vector<float> xyz;
    for (int i = 0; i < 900; ++i) xyz.push_back(static_cast<float>(i));
    const int positions = scene.add_positions(xyz);
    for (const int first : {0, 99, 297}) {
        const int indices = scene.add_accessor<std::int32_t>({first + 2, first, first + 1}, 5125, "SCALAR");
        scene.add_body("a", scene.add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}));
    }
    const WorldMesh world = read_scene(scene, {.weld = Weld::no});
    ASSERT_EQ(world.shapes.size(), 3u);
    EXPECT_EQ(coordinates(world.shapes[2]), (std::vector<double>{891, 892, 893, 894, 895, 896, 897, 898, 899}));
    EXPECT_EQ(world.shapes[2].triangles, (std::vector<std::int32_t>{2, 0, 1}));
}

TEST(Gltf, quantized_positions_are_read) {
    GltfScene scene;
    const int shorts = scene.add_accessor<std::int16_t>({32767, -32767, -32768, 3, 0, 0, 0, 5, 0}, 5122, "VEC3");
    scene.add_body("a", scene.add_mesh({{{"attributes", {{"POSITION", shorts}}}}}));
    scene.json["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_materials_unlit"};
    EXPECT_EQ(coordinates(read_scene(scene).shapes[0]), (std::vector<double>{32767, -32767, -32768, 3, 0, 0, 0, 5, 0}));
    scene.json["accessors"].at(static_cast<std::size_t>(shorts))["normalized"] = true;
    const WorldMesh world = read_scene(scene, {.precision = Precision::float64});
    EXPECT_EQ(coordinates(world.shapes[0]), (std::vector<double>{1, -1, -1, 3.0 / 32767, 0, 0, 0, 5.0 / 32767, 0}));
    EXPECT_EQ(coordinates(read_scene(scene).shapes[0])[3], static_cast<float>(3.0 / 32767));

    const auto expect_read = [](auto most, int component_type) {
        GltfScene other;
        using T = decltype(most);
        const int positions = other.add_accessor(std::vector<T>{most, 3, 0, 0, 1, 0, 0, 0, 1}, component_type, "VEC3");
        other.add_body("a", other.add_mesh({{{"attributes", {{"POSITION", positions}}}}}));
        const double large = most;
        EXPECT_EQ(coordinates(read_scene(other).shapes[0]), (std::vector<double>{large, 3, 0, 0, 1, 0, 0, 0, 1}));
        other.json["accessors"].at(static_cast<std::size_t>(positions))["normalized"] = true;
        EXPECT_EQ(coordinates(read_scene(other, {.precision = Precision::float64}).shapes[0]),
                  (std::vector<double>{1, 3 / large, 0, 0, 1 / large, 0, 0, 0, 1 / large}));
    };
    expect_read(std::int8_t{127}, 5120);
    expect_read(std::uint8_t{255}, 5121);
    expect_read(std::uint16_t{65535}, 5123);
}

TEST(Gltf, positions_can_be_interleaved_with_other_data) {
    GltfScene scene;
    const int positions = scene.add_positions({0, 0, 0, 7, 1, 0, 0, 7, 0, 1, 0, 7});
    scene.json["accessors"].at(static_cast<std::size_t>(positions))["count"] = 3;
    scene.json["bufferViews"][0]["byteStride"] = 16;
    scene.add_body("a", scene.add_mesh({{{"attributes", {{"POSITION", positions}}}}}));
    EXPECT_EQ(coordinates(read_scene(scene).shapes[0]), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    scene.json["accessors"].at(static_cast<std::size_t>(positions))["byteOffset"] = 4;
    EXPECT_EQ(coordinates(read_scene(scene, {.weld = Weld::no}).shapes[0]),
              (std::vector<double>{0, 0, 7, 0, 0, 7, 1, 0, 7}));
    scene.json["accessors"].at(static_cast<std::size_t>(positions))["byteOffset"] = 8;
    expect_refused(scene, "accessors[0] announces 3 elements, but bufferViews[0] holds 2");
}

TEST(Gltf, unsupported_skins_morphs_and_instances_give_warnings) {
    GltfScene scene;
    const int shape = scene.add_tetrahedron();
    scene.add_body("a", shape);
    scene.json["nodes"][0]["skin"] = 0;
    scene.json["meshes"].at(static_cast<std::size_t>(shape))["primitives"][0]["targets"] = {{{"POSITION", 0}}};
    scene.json["meshes"].at(static_cast<std::size_t>(shape))["weights"] = {0};
    scene.add_node({{"mesh", shape}, {"extensions", {{"EXT_mesh_gpu_instancing", Json::object()}}}});
    EXPECT_EQ(read_scene(scene).warnings.size(), 2u);
    scene.json["meshes"].at(static_cast<std::size_t>(shape))["weights"] = {0.5};
    const std::vector<std::string> warnings = read_scene(scene).warnings;
    ASSERT_EQ(warnings.size(), 3u);
    EXPECT_TRUE(contains(warnings[0], "meshes[0].primitives[0] has morph targets"));
    EXPECT_TRUE(contains(warnings[1], "nodes[0] has a skin"));
    EXPECT_TRUE(contains(warnings[2], "nodes[1] has instances"));
}

TEST(Gltf, error_in_a_transform_names_its_node) {
    const auto scene_with = [](const Json& transform) {
        GltfScene scene;
        Json node = {{"name", "elbow"}, {"mesh", scene.add_tetrahedron()}};
        node.update(transform);
        scene.add_node(node);
        return scene;
    };
    expect_refused(scene_with({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}}}),
                   "nodes[0] 'elbow' has a matrix that is not affine");
    expect_refused(scene_with({{"matrix", {1, 0, 0, 1e-9, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}), "is not affine");
    expect_refused(scene_with({{"matrix", {1, 0, 0}}}), "nodes[0].matrix holds 3 numbers, not 16");
    expect_refused(scene_with({{"translation", {1, 0, nullptr}}}),
                   "nodes[0].translation holds a value that is not a number");
    expect_refused(scene_with({{"rotation", {0, 0, 0, 0}}}),
                   "nodes[0] 'elbow' has a rotation whose length is 0 or not finite");
    expect_refused(scene_with({{"scale", "large"}}), "nodes[0].scale is not a list");

    GltfScene scene = scene_with({{"scale", {1e200, 1, 1}}, {"children", {1}}});
    scene.add_node({{"name", "wrist"}, {"mesh", 0}, {"scale", {1e200, 1, 1}}}, false);
    expect_refused(scene, "nodes[1] 'wrist' has a transform that is not finite");
    std::string text = scene_with({{"scale", {12345, 1, 1}}}).glb();
    text.replace(text.find("12345"), 5, "1e999");
    EXPECT_TRUE(contains(error_of([&] { read_scene(text); }).what(), "a number beyond float64"));
}

TEST(Gltf, mesh_holds_all_bodies_as_posed) {
    const Folder folder;
    const fs::path path = folder.write("a.glb", crumple::test::robot_scene().glb());
    const TriangleMesh mesh = read_mesh(path), posed = posed_mesh(read_world(path));
    EXPECT_EQ(coordinates(mesh), coordinates(posed));
    EXPECT_EQ(mesh.triangles, posed.triangles);
    std::vector<double> expected;
    for (const auto& [x, y, z] :
         std::vector<std::array<double, 3>>{{0, 0, 0}, {1, 0, 0}, {1.25, 0.125, 0.125}, {9, 9, 9}})
        expected.insert(expected.end(), {x, y, z, x + 1, y, z, x, y + 1, z, x, y, z + 1});
    EXPECT_EQ(coordinates(mesh), expected);
    EXPECT_TRUE(mesh.groups.empty());
    EXPECT_EQ(read_mesh(path, {.weld = Weld::no}).triangle_count(), mesh.triangle_count());
    EXPECT_EQ(error_of([&] { read_world(path, {.group_property = "part"}); }).code, ErrorCode::invalid_argument);
}

TEST(Gltf, mirrored_bodies_keep_their_outward_orientation) {
    GltfScene scene;
    scene.add_node({{"name", "left"}, {"mesh", scene.add_tetrahedron()}, {"scale", {-2, 1, 1}}});
    const std::string glb = scene.glb();
    EXPECT_EQ(read_scene(glb).shapes[0].triangles, (std::vector<std::int32_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
    const TriangleMesh mesh = read_bytes(glb, "a.glb");
    EXPECT_EQ(mesh.triangles, (std::vector<std::int32_t>{0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2}));
    EXPECT_EQ(coordinates(mesh), (std::vector<double>{0, 0, 0, -2, 0, 0, 0, 1, 0, 0, 0, 1}));
}

TEST(Gltf, distant_bodies_in_float32_give_a_warning) {
    const auto warnings_at = [](double x, const ReadOptions& options = {}) {
        GltfScene scene;
        scene.add_body("a", scene.add_tetrahedron(), {x, 0, 0});
        scene.add_body("b", 0, {-x, 0, 0});
        return read_scene(scene.glb(), options).warnings;
    };
    EXPECT_TRUE(warnings_at(1000).empty());
    ASSERT_EQ(warnings_at(1100).size(), 1u);
    EXPECT_TRUE(contains(warnings_at(1100)[0], "body 'a' is more than 1024 times its size away from the origin"));
    EXPECT_TRUE(warnings_at(1100, {.precision = Precision::float64}).empty());
}

TEST(Gltf, scenes_without_triangles_give_a_warning) {
    GltfScene scene;
    scene.add_body("a", scene.add_mesh({0, 0, 0, 1, 0, 0}, {}));
    const std::vector<std::string> warnings = read_scene(scene.glb()).warnings;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(contains(warnings[0], "it holds no triangles"));
}

TEST(Gltf, sparse_accessors_replace_elements) {
    GltfScene scene;
    const int shape = scene.add_tetrahedron();
    scene.add_body("a", shape);
    scene.add_accessor(std::vector<std::uint16_t>{1, 3}, 5123, "SCALAR");
    scene.add_accessor(std::vector<float>{5, 0, 0, 0, 0, 7}, 5126, "VEC3");
    const auto view = [&](int accessor) {
        return scene.json["accessors"][static_cast<std::size_t>(accessor)]["bufferView"];
    };
    scene.json["accessors"][0]["sparse"] = {{"count", 2},
                                            {"indices", {{"bufferView", view(2)}, {"componentType", 5123}}},
                                            {"values", {{"bufferView", view(3)}}}};
    EXPECT_EQ(coordinates(read_scene(scene.glb()).shapes[0]),
              (std::vector<double>{0, 0, 0, 5, 0, 0, 0, 1, 0, 0, 0, 7}));
    scene.json["accessors"][0].erase("bufferView");  // without it, elements that are not replaced are 0
    EXPECT_EQ(coordinates(read_scene(scene.glb(), {.weld = Weld::no}).shapes[0]),
              (std::vector<double>{0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 7}));
}

TEST(Gltf, primitives_without_positions_are_skipped_with_a_warning) {
    GltfScene scene;
    scene.add_body("a", scene.add_tetrahedron());
    scene.json["meshes"][0]["primitives"].push_back({{"attributes", {{"NORMAL", 0}}}});
    const WorldMesh world = read_scene(scene.glb());
    EXPECT_EQ(world.triangle_count(), 4);
    ASSERT_EQ(world.warnings.size(), 1u);
    EXPECT_TRUE(contains(world.warnings[0], "meshes[0].primitives[1] has no attribute POSITION and is skipped"));
}

TEST(Gltf, written_world_keeps_bodies_and_shared_shapes) {
    const Folder folder;
    const WorldMesh world = read_scene(crumple::test::robot_scene().glb());
    write_world(folder / "a.glb", world);
    const WorldMesh back = read_world(folder / "a.glb");
    EXPECT_EQ(back.shapes.size(), world.shapes.size());
    ASSERT_EQ(back.bodies.size(), world.bodies.size());
    for (std::size_t b = 0; b < world.bodies.size(); ++b) EXPECT_EQ(back.bodies[b].name, world.bodies[b].name);
    EXPECT_EQ(coordinates(posed_mesh(back)), coordinates(posed_mesh(world)));
    EXPECT_TRUE(back.warnings.empty());
    std::ostringstream out;
    write_world(out, world, MeshFormat::glb);
    EXPECT_EQ(out.str(), bytes_of(folder / "a.glb"));
    EXPECT_EQ(error_of([&] { write_world(out, world, MeshFormat::ply); }).code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace crumple::io::test
