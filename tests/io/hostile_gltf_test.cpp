// Tests of glTF that is cut, damaged or absurd: it gives an error or a sound world, never a crash, a hang or a huge
// allocation.

#include <cmath>
#include <functional>

#include "scenes.h"

namespace crumple::io::test {
namespace {

using Json = nlohmann::json;

/// Returns the world, or nothing after an Error. Any other exception fails the test.
std::optional<WorldMesh> try_read_world(const std::string& bytes) {
    try {
        return read_scene(bytes);
    } catch (const Error& error) {
        EXPECT_TRUE(contains(error.what(), "a.glb")) << error.what();
        return std::nullopt;
    }
}

void expect_sound(const WorldMesh& world) {
    for (const TriangleMesh& shape : world.shapes) {
        for (const std::int32_t corner : shape.triangles) ASSERT_TRUE(corner >= 0 && corner < shape.vertex_count());
        for (const double x : coordinates(shape)) ASSERT_TRUE(std::isfinite(x));
    }
    for (const NamedBody& body : world.bodies) {
        ASSERT_TRUE(body.shape >= 0 && static_cast<std::size_t>(body.shape) < world.shapes.size());
        for (const double x : body.pose.rows) ASSERT_TRUE(std::isfinite(x));
    }
}

/// Returns a scene with everything that a description may hold.
GltfScene full_scene() {
    GltfScene scene = crumple::test::robot_scene();
    const int strip = scene.add_indices({0, 1, 2, 3}),
              bytes = scene.add_accessor<std::uint8_t>({0, 1, 2}, 5121, "SCALAR");
    const int shape = scene.add_mesh({{{"attributes", {{"POSITION", 0}}}, {"indices", strip}, {"mode", 5}},
                                      {{"attributes", {{"POSITION", 0}}}, {"indices", bytes}, {"mode", 6}},
                                      {{"attributes", {{"POSITION", 0}}}, {"mode", 1}}});
    const int child =
        scene.add_node({{"mesh", shape}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}}}, false);
    scene.add_node({{"rotation", {0, 0, 1, 0}}, {"scale", {1, 2, 3}}, {"children", {child}}});
    scene.json["meshes"].at(static_cast<std::size_t>(shape))["weights"] = {1};
    return scene;
}

TEST(HostileGltf, every_truncation_is_an_error) {
    const std::string whole = full_scene().glb();
    ASSERT_TRUE(try_read_world(whole));
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_FALSE(try_read_world(whole.substr(0, size))) << size;
        std::string announced = whole.substr(0, size);
        if (size < 12) continue;
        const auto length = little_endian(static_cast<std::uint32_t>(size));
        std::copy(length.begin(), length.end(), announced.begin() + 8);
        EXPECT_FALSE(try_read_world(announced)) << size;
    }
}

TEST(HostileGltf, every_damaged_byte_is_an_error_or_gives_a_sound_world) {
    const std::string whole = full_scene().glb();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const unsigned byte = static_cast<unsigned char>(whole[i]);
        for (const unsigned change : {0x01u, 0x10u, 0x80u, 0xffu, byte ^ '9', byte ^ '-', byte ^ '"', byte ^ ' '}) {
            std::string bytes = whole;
            bytes[i] = static_cast<char>(byte ^ change);
            SCOPED_TRACE("byte " + std::to_string(i) + " changed by " + std::to_string(change));
            if (const auto world = try_read_world(bytes)) expect_sound(*world);
        }
    }
}

/// Calls visit() with copies of the description in which `value` replaces each value in turn.
void for_each_replacement(const Json& whole, const Json& value, const std::function<void(const Json&)>& visit) {
    const Json flat = whole.flatten();
    for (const auto& item : flat.items()) {
        for (Json::json_pointer place(item.key()); !place.empty(); place.pop_back()) {
            Json changed = whole;
            changed[place] = value;
            visit(changed);
        }
    }
}

TEST(HostileGltf, replaced_json_value_is_an_error_or_gives_a_sound_world) {
    GltfScene scene = full_scene();
    scene.json["buffers"] = {{{"byteLength", scene.bytes.size()}}};
    const std::vector<Json> values{nullptr,
                                   true,
                                   -1,
                                   0,
                                   1,
                                   5126,
                                   4294967296,
                                   9223372036854775807u,
                                   18446744073709551615u,
                                   1.5,
                                   1e300,
                                   "",
                                   "x",
                                   Json::array(),
                                   {0, 0},
                                   Json::object(),
                                   {{"a", 1}}};
    for (const Json& value : values)
        for_each_replacement(scene.json, value, [&](const Json& changed) {
            SCOPED_TRACE(changed.dump());
            if (const auto world = try_read_world(GltfScene::glb_of(changed.dump(), scene.bytes))) expect_sound(*world);
        });
}

TEST(HostileGltf, error_of_a_node_cycle_names_a_node) {
    GltfScene scene = crumple::test::robot_scene();
    scene.json["nodes"][0]["children"] = {1};
    expect_refused(scene, "nodes[1] 'arm' is referred to twice");
    scene.json["scenes"][0]["nodes"] = {0};
    scene.json["nodes"][1]["children"] = {2};
    scene.json["nodes"][2]["children"] = {0};
    expect_refused(scene, "nodes[0] 'base' is referred to twice");
    scene.json["nodes"][2]["children"] = {2};
    expect_refused(scene, "nodes[2] 'hand' is referred to twice");
}

TEST(HostileGltf, error_of_an_index_out_of_range_names_its_place) {
    const GltfScene good = crumple::test::robot_scene();
    const auto expect_refused_at = [&](const char* pointer, const Json& value, const std::string& what) {
        GltfScene scene = good;
        scene.json[Json::json_pointer(pointer)] = value;
        expect_refused(scene, what);
    };
    expect_refused_at("/nodes/1/mesh", 1, "nodes[1].mesh is 1, but there are 1 meshes");
    expect_refused_at("/nodes/1/mesh", -1, "nodes[1].mesh is not an integer");
    expect_refused_at("/nodes/1/mesh", 4294967296, "nodes[1].mesh is 4294967296, but there are 1 meshes");
    expect_refused_at("/nodes/1/children", {4}, "nodes[1].children names node 4 of 4");
    expect_refused_at("/scenes/0/nodes", {9}, "scenes[0].nodes names node 9 of 4");
    expect_refused_at("/scene", 3, "scene is 3, but there are 1 scenes");
    expect_refused_at("/meshes/0/primitives/0/indices", 7, "is 7, but there are 2 accessors");
    expect_refused_at("/meshes/0/primitives/0/indices", 0, "accessors[0].type is 'VEC3', not 'SCALAR'");
    expect_refused_at("/meshes/0/primitives/0/attributes/POSITION", 1, "accessors[1].type is 'SCALAR', not 'VEC3'");
    expect_refused_at("/meshes/0/primitives/0/mode", 7, "mode is 7");
    expect_refused_at("/accessors/0/bufferView", 2, "accessors[0].bufferView is 2, but there are 2 bufferViews");
    expect_refused_at("/accessors/0/componentType", 5124, "is 5124, which glTF does not define");
    expect_refused_at("/accessors/0/sparse", Json::object(), "accessors[0].sparse lacks its indices or its values");
    const auto sparse = [](int count, const Json& indices) {
        return Json{{"count", count}, {"indices", indices}, {"values", {{"bufferView", 0}}}};
    };
    expect_refused_at("/accessors/0/sparse", sparse(1, {{"bufferView", 1}, {"componentType", 5126}}),
                      "accessors[0].sparse.indices.componentType is 5126, which is not a type of indices");
    expect_refused_at("/accessors/0/sparse", sparse(99, {{"bufferView", 1}, {"componentType", 5123}}),
                      "accessors[0].sparse.values announces 99 elements");
    expect_refused_at("/accessors/0/sparse",
                      sparse(1, {{"bufferView", 0}, {"byteOffset", 14}, {"componentType", 5121}}),
                      "accessors[0].sparse.indices names element 128 of 4");
    expect_refused_at("/accessors/0/sparse", sparse(-1, {{"bufferView", 1}, {"componentType", 5123}}),
                      "accessors[0].sparse.count is not an integer");
    expect_refused_at("/accessors/1/count", 11, "a list of triangles with 11 corners");
    expect_refused_at("/accessors/0/count", 3, "index 5 of accessors[1] names vertex 3 of 3");
    expect_refused_at("/bufferViews/0/buffer", 1, "bufferViews[0].buffer is 1, but there are 1 buffers");
    expect_refused_at("/extensionsRequired", {"KHR_draco_mesh_compression"}, "'KHR_draco_mesh_compression'");
    expect_refused_at("/asset/version", "1.0", "asset.version is '1.0'");
}

TEST(HostileGltf, absurd_counts_are_errors) {
    const GltfScene good = crumple::test::robot_scene();
    for (const Json& count : std::vector<Json>{5, 1099511627776, 9223372036854775807}) {
        for (const char* pointer : {"/accessors/0/count", "/bufferViews/0/byteLength", "/bufferViews/0/byteOffset",
                                    "/bufferViews/0/byteStride", "/accessors/0/byteOffset"}) {
            GltfScene scene = good;
            scene.json[Json::json_pointer(pointer)] = count;
            if (count != 5 || std::string_view(pointer) == "/accessors/0/count")
                expect_refused(scene, pointer == std::string("/bufferViews/0/byteStride") ? "elements" : "");
        }
    }
    GltfScene scene = good;
    scene.json["buffers"] = {{{"byteLength", 1099511627776}}};
    expect_refused(scene, "buffers[0].byteLength is 1099511627776");
}

TEST(HostileGltf, too_many_meshes_over_the_same_data_are_refused) {
    GltfScene scene;
    const int positions = scene.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int indices = scene.add_indices(std::vector<std::uint16_t>(60'000));
    for (int i = 0; i < 100; ++i) {
        // The list of primitives differs from mesh to mesh, so that no two meshes become one shape.
        Json primitives = Json::array();
        for (int k = 0; k < 12; ++k)
            primitives.push_back(
                {{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 4 + (i >> k & 1)}});
        scene.add_body("a", scene.add_mesh(primitives));
    }
    expect_refused(scene, "more than 8 triangles per byte");
}

TEST(HostileGltf, too_many_primitives_over_the_same_data_are_refused) {
    GltfScene scene;
    const int positions = scene.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    std::vector<std::uint8_t> turns(100'000);
    for (std::size_t i = 0; i < turns.size(); ++i) turns[i] = static_cast<std::uint8_t>(i % 3);
    const int indices = scene.add_accessor(turns, 5121, "SCALAR");
    // The triangles of all primitives would take 24 GB.
    scene.add_body("a", scene.add_mesh(Json(
                            10'000, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 5}})));
    expect_refused(scene, "more than 8 triangles per byte");
}

TEST(HostileGltf, deep_trees_are_read_and_deep_json_is_refused) {
    GltfScene scene;
    const int shape = scene.add_tetrahedron();
    const int count = 10'000;
    for (int i = 0; i < count; ++i) {
        Json node = {{"name", "link"}, {"mesh", shape}, {"translation", {1, 0, 0}}};
        if (i + 1 < count) node["children"] = {i + 1};
        scene.add_node(std::move(node), i == 0);
    }
    const auto world = try_read_world(scene.glb());
    ASSERT_TRUE(world);
    ASSERT_EQ(world->bodies.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(world->bodies.back().pose.rows[3], count);
    EXPECT_EQ(world->bodies.back().name, "link_10000");
    EXPECT_FALSE(try_read_world(GltfScene::glb_of(std::string(100'000, '['), {})));
    EXPECT_FALSE(try_read_world(GltfScene::glb_of("{\"asset\":" + std::string(100'000, '['), {})));
}

}  // namespace
}  // namespace crumple::io::test
