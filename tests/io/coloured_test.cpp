#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include "io/formats.h"
#include "samples.h"

namespace crumple::io::test {
namespace {

/// Returns a result in which triangle 1 of sample_mesh() collides.
Intersections one_hit() {
    Intersections collisions;
    for (const std::uint8_t hit : std::vector<std::uint8_t>{0, 1, 0}) collisions.hit.push_back(hit);
    return collisions;
}

Intersections hits_of_two() {
    Intersections collisions = one_hit();
    for (const std::uint8_t hit : std::vector<std::uint8_t>{0, 0, 1}) collisions.hit_second.push_back(hit);
    return collisions;
}

/// Returns a colour channel of the faces, read as groups.
std::vector<std::int32_t> face_channel(const fs::path& path, const char* channel) {
    return read_mesh(path, {.group_property = channel}).groups;
}

TEST(ColouredMesh, ply_colours_colliding_faces_and_their_vertices) {
    const Folder folder;
    write_coloured(folder / "a.ply", sample_mesh(), nullptr, one_hit());
    expect_same(read_mesh(folder / "a.ply"), sample_mesh());
    EXPECT_EQ(face_channel(folder / "a.ply", "red"), (std::vector<std::int32_t>{178, 213, 178}));
    EXPECT_EQ(face_channel(folder / "a.ply", "green"), (std::vector<std::int32_t>{178, 94, 178}));
    EXPECT_EQ(face_channel(folder / "a.ply", "blue"), (std::vector<std::int32_t>{178, 0, 178}));
    const std::string bytes = bytes_of(folder / "a.ply");
    const std::size_t body = bytes.find("end_header\n") + 11;
    for (std::size_t v = 0; v < 5; ++v) {
        const bool hit = v == 0 || v == 2 || v == 3;
        EXPECT_EQ(bytes.substr(body + 27 * v + 24, 3), hit ? std::string("\xd5\x5e\0", 3) : "\xb2\xb2\xb2") << v;
    }
}

TEST(ColouredMesh, ply_and_obj_hold_the_second_mesh_after_the_first) {
    const Folder folder;
    TriangleMesh second = sample_mesh();
    second.vertices = std::vector<float>(15, 0.25f);
    for (const char* const name : {"a.ply", "a.obj"}) {
        write_coloured(folder / name, sample_mesh(), &second, hits_of_two());
        const TriangleMesh both = read_mesh(folder / name);
        EXPECT_EQ(both.precision(), ScalarType::float64) << "the first mesh loses no bit";
        std::vector<double> xyz = coordinates(sample_mesh());
        xyz.resize(30, 0.25);
        EXPECT_EQ(coordinates(both), xyz) << name;
        EXPECT_EQ(both.triangles, (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3, 4, 1, 0, 5, 6, 7, 5, 7, 8, 9, 6, 5}));
    }
    EXPECT_EQ(face_channel(folder / "a.ply", "blue"), (std::vector<std::int32_t>{178, 0, 178, 178, 178, 0}));
}

TEST(ColouredMesh, obj_keeps_the_order_of_triangles_and_names_materials) {
    const Folder folder;
    write_coloured(folder / "a.obj", sample_mesh(), nullptr, one_hit());
    expect_same(read_mesh(folder / "a.obj"), sample_mesh());
    const std::string text = bytes_of(folder / "a.obj");
    EXPECT_NE(text.find("mtllib a.mtl\n"), text.npos);
    EXPECT_NE(text.find("usemtl free\nf 1 2 3\nusemtl colliding\nf 1 3 4\nusemtl free\nf 5 2 1\n"), text.npos) << text;
    const std::string materials = bytes_of(folder / "a.mtl");
    EXPECT_NE(materials.find("newmtl free\nKd 0.69"), materials.npos) << materials;
    EXPECT_NE(materials.find("newmtl colliding\nKd 0.83"), materials.npos) << materials;
}

/// Returns a mesh of two polygons: a triangle and a square.
TriangleMesh mesh_with_polygons() {
    return read_bytes("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 5 1 0\nv 6 0 0\nf 5 6 7\nf 1 2 3 4\n", "a.obj");
}

/// Returns a result in which triangle 0 meets both triangles of polygon 1, and these meet each other.
Intersections hits_of_polygons() {
    Intersections collisions;
    for (const Pair pair : {Pair{0, 1}, {0, 2}, {1, 2}}) collisions.pairs.push_back(pair);
    for (const std::int64_t offset : {0, 2, 3, 3}) collisions.offsets.push_back(offset);
    for (const std::uint8_t hit : std::vector<std::uint8_t>{1, 1, 1}) collisions.hit.push_back(hit);
    return collisions;
}

TEST(ResultsByPolygon, each_pair_of_polygons_is_counted_once) {
    const Intersections found = by_polygon(mesh_with_polygons(), nullptr, hits_of_polygons());
    EXPECT_EQ(std::vector<Pair>(found.pairs.begin(), found.pairs.end()), (std::vector<Pair>{{0, 1}, {1, 1}}));
    EXPECT_EQ(std::vector<std::int64_t>(found.offsets.begin(), found.offsets.end()),
              (std::vector<std::int64_t>{0, 1, 2}));
    EXPECT_EQ(std::vector<std::uint8_t>(found.hit.begin(), found.hit.end()), (std::vector<std::uint8_t>{1, 1}));
    const TriangleMesh second = sample_mesh();
    const TriangleMesh first = mesh_with_polygons();
    Intersections between = one_hit();
    between.pairs.push_back({1, 2});
    for (const std::uint8_t hit : std::vector<std::uint8_t>{0, 0, 1}) between.hit_second.push_back(hit);
    const Intersections both = by_polygon(first, &second, between);
    EXPECT_EQ(std::vector<Pair>(both.pairs.begin(), both.pairs.end()), (std::vector<Pair>{{1, 2}}));
    EXPECT_EQ(both.hit.size(), 2u);
    EXPECT_EQ(both.hit_second.size(), 3u) << "without polygons each triangle is one";
    EXPECT_EQ(error_of([&] { by_polygon(first, nullptr, Intersections()); }).code, ErrorCode::invalid_argument);
}

TEST(ResultsByPolygon, polygons_are_preserved_and_have_one_colour) {
    const Folder folder;
    const TriangleMesh mesh = mesh_with_polygons(), second = sample_mesh();
    Intersections found = by_polygon(mesh, nullptr, hits_of_polygons());
    found.hit[0] = 0;
    for (const char* const name : {"a.ply", "a.obj"}) {
        write_coloured(folder / name, mesh, nullptr, found);
        const TriangleMesh again = read_mesh(folder / name);
        EXPECT_EQ(again.polygons.corners, mesh.polygons.corners) << name;
        EXPECT_EQ(again.triangles, mesh.triangles) << name;
    }
    EXPECT_EQ(face_channel(folder / "a.ply", "red"), (std::vector<std::int32_t>{178, 213, 213}));
    write_coloured(folder / "t.ply", mesh, nullptr, hits_of_polygons());
    EXPECT_TRUE(read_mesh(folder / "t.ply").polygons.empty()) << "hits of triangles colour triangles";
    for (const std::uint8_t hit : std::vector<std::uint8_t>{0, 0, 1}) found.hit_second.push_back(hit);
    write_coloured(folder / "b.ply", mesh, &second, found);
    EXPECT_EQ(read_mesh(folder / "b.ply").polygons.of_triangle, (std::vector<std::int32_t>{0, 1, 1, 2, 3, 4}));
    EXPECT_EQ(face_channel(folder / "b.ply", "red"), (std::vector<std::int32_t>{178, 213, 213, 178, 178, 213}));
}

TEST(ResultsByPolygon, coloured_ply_preserves_a_polygon_of_300_corners) {
    const Folder folder;
    std::string text, face = "f";
    for (int i = 0; i < 300; ++i) {
        text += "v " + std::to_string(i) + ' ' + std::to_string(i * i) + " 0\n";
        face += ' ' + std::to_string(i + 1);
    }
    const TriangleMesh mesh = read_bytes(text + face + '\n', "a.obj");
    Intersections none;
    none.hit.push_back(0);
    write_coloured(folder / "a.ply", mesh, nullptr, none);
    EXPECT_EQ(read_mesh(folder / "a.ply").polygons.corners, mesh.polygons.corners);
}

TEST(ResultsByPolygon, inconsistent_polygons_are_refused) {
    const Folder folder;
    const auto refused = [&](auto change) {
        TriangleMesh mesh = mesh_with_polygons();
        change(mesh.polygons);
        const auto write = [&] { write_coloured(folder / "a.ply", mesh, nullptr, hits_of_polygons()); };
        EXPECT_EQ(error_of(write).code, ErrorCode::invalid_argument);
    };
    refused([](Polygons& p) { p.of_triangle.pop_back(); });
    refused([](Polygons& p) { p.of_triangle[0] = 1; });
    refused([](Polygons& p) { p.offsets.clear(); });
    refused([](Polygons& p) { p.offsets[1] = 4; });
    refused([](Polygons& p) { p.offsets[1] = -5; });
    refused([](Polygons& p) { p.corners[0] = 7; });
    refused([](Polygons& p) { p.corners.push_back(0); });
}

TEST(ColouredMesh, mtl_file_of_another_program_is_not_overwritten) {
    const Folder folder;
    folder.write("a.mtl", "newmtl mine\n");
    const auto write = [&] { write_coloured(folder / "a.obj", sample_mesh(), nullptr, one_hit()); };
    EXPECT_EQ(error_of(write).code, ErrorCode::file);
    EXPECT_EQ(bytes_of(folder / "a.mtl"), "newmtl mine\n");
    EXPECT_FALSE(fs::exists(folder / "a.obj"));
    fs::remove(folder / "a.mtl");
    write();
    write();  // files that it has written before are replaced
}

TEST(ColouredMesh, html_arrays_of_corners_colours_and_contacts_have_the_expected_length) {
    const Folder folder;
    Intersections found = one_hit();
    found.pairs.push_back({1, 2});
    found.contacts.kinds.push_back(ContactKind::segment);
    for (const std::int64_t offset : {0, 2}) found.contacts.offsets.push_back(offset);
    for (const double x : {0.25, 0.75}) found.contacts.points.push_back({x, x, 0});
    write_coloured(folder / "a.html", sample_mesh(), nullptr, found);
    const std::string page = bytes_of(folder / "a.html"), piece = to_html(sample_mesh(), nullptr, found, 320);
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_TRUE(piece.starts_with("<div id=\"crumple-"));
    EXPECT_NE(piece.find("height:320px"), piece.npos);
    const auto length = [&](const std::string& name) {  // bytes of an array that is encoded in base64
        const std::size_t begin = page.find('"' + name + "\": \"") + name.size() + 5, end = page.find('"', begin);
        return (end - begin) / 4 * 3 - static_cast<std::size_t>(std::count(&page[end] - 2, &page[end], '='));
    };
    EXPECT_EQ(length("corners"), 3 * 9 * sizeof(float));
    EXPECT_EQ(length("colours"), 3 * 9u);
    EXPECT_EQ(length("lines"), 2 * 3 * sizeof(float));
    EXPECT_EQ(length("points"), 0u);
    EXPECT_EQ(length("contact"), 3u);
    EXPECT_EQ(error_of([&] { to_html(sample_mesh(), nullptr, found, 0); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { to_html(sample_mesh(), nullptr, {}, 9); }).code, ErrorCode::invalid_argument);
    std::ostringstream out;
    write_coloured(out, sample_mesh(), nullptr, found, MeshFormat::glb);
    write_coloured(folder / "a.glb", sample_mesh(), nullptr, found);
    EXPECT_EQ(out.str(), bytes_of(folder / "a.glb"));
    const auto obj = [&] { write_coloured(out, sample_mesh(), nullptr, found, MeshFormat::obj); };
    EXPECT_EQ(error_of(obj).code, ErrorCode::invalid_argument);
}

tinygltf::Model load_glb(const fs::path& path) {
    tinygltf::Model model;
    std::string error, warning;
    EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, path.string())) << error;
    EXPECT_EQ(error + warning, "");
    return model;
}

template <class T>
std::vector<T> values(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    std::vector<T> result(view.byteLength / sizeof(T));
    EXPECT_EQ(view.byteOffset % 4, 0u);
    std::memcpy(result.data(), model.buffers[0].data.data() + view.byteOffset, view.byteLength);
    return result;
}

TEST(ColouredMesh, glb_has_one_primitive_and_material_per_colour) {
    const Folder folder;
    write_coloured(folder / "a.glb", sample_mesh(), nullptr, one_hit());
    const tinygltf::Model model = load_glb(folder / "a.glb");
    ASSERT_EQ(model.meshes.size(), 1u);
    const auto& primitives = model.meshes[0].primitives;
    ASSERT_EQ(primitives.size(), 2u);
    EXPECT_EQ(values<std::uint32_t>(model, primitives[0].indices), (std::vector<std::uint32_t>{0, 1, 2, 4, 1, 0}));
    EXPECT_EQ(values<std::uint32_t>(model, primitives[1].indices), (std::vector<std::uint32_t>{0, 2, 3}));
    EXPECT_NE(primitives[0].material, primitives[1].material);
    for (const auto& material : model.materials) EXPECT_TRUE(material.doubleSided);
    const int positions = primitives[0].attributes.at("POSITION");
    const std::vector<double> expected = coordinates(sample_mesh());
    EXPECT_EQ(values<float>(model, positions), std::vector<float>(expected.begin(), expected.end()));
    EXPECT_EQ(model.accessors[static_cast<std::size_t>(positions)].minValues, (std::vector<double>{0, 0, -2}));
    EXPECT_EQ(model.accessors[static_cast<std::size_t>(positions)].maxValues, (std::vector<double>{1, 1, 0}));
    EXPECT_TRUE(model.nodes[0].translation.empty());
}

TEST(ColouredMesh, glb_stores_distant_float64_meshes_relative_to_an_origin) {
    const Folder folder;
    TriangleMesh mesh = sample_mesh();
    for (double& x : std::get<std::vector<double>>(mesh.vertices)) x += 5e6;
    write_coloured(folder / "a.glb", mesh, nullptr, one_hit());
    const tinygltf::Model model = load_glb(folder / "a.glb");
    ASSERT_EQ(model.nodes[0].translation.size(), 3u);
    const auto positions = values<float>(model, model.meshes[0].primitives[0].attributes.at("POSITION"));
    const std::vector<double> expected = coordinates(mesh);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(model.nodes[0].translation[i % 3] + positions[i], expected[i], 1e-6) << "coordinate " << i;
    }
}

TEST(ColouredMesh, glb_holds_no_empty_primitives) {
    const Folder folder;
    write_coloured(folder / "empty.glb", {}, nullptr, {});
    EXPECT_TRUE(load_glb(folder / "empty.glb").meshes.empty());
    Intersections none = one_hit();
    none.hit.fill(0);
    write_coloured(folder / "free.glb", sample_mesh(), nullptr, none);
    EXPECT_EQ(load_glb(folder / "free.glb").meshes[0].primitives.size(), 1u);
}

TEST(ColouredAnimation, animation_shows_one_frame_at_a_time) {
    const Folder folder;
    TriangleMesh longer = sample_mesh();
    longer.triangles.insert(longer.triangles.end(), {0, 1, 2});
    Intersections hits = one_hit();
    hits.hit.push_back(1);
    ColouredAnimation animation(10);
    animation.add(sample_mesh(), nullptr, one_hit());
    animation.add({}, nullptr, {});
    animation.add(longer, nullptr, hits);
    animation.write(folder / "three.glb");
    animation.add(sample_mesh(), nullptr, one_hit());
    animation.write(folder / "four.glb");
    std::ofstream full("/dev/full");
    EXPECT_THROW(animation.write(full), Error);
    for (const auto& [name, frames] : {std::pair("three.glb", 3), {"four.glb", 4}}) {
        const tinygltf::Model model = load_glb(folder / name);
        ASSERT_EQ(model.animations.size(), 1u);
        ASSERT_EQ(model.meshes.size(), static_cast<std::size_t>(frames) - 1);  // the empty frame has no mesh
        ASSERT_EQ(model.animations[0].channels.size(), model.meshes.size());
        EXPECT_EQ(model.scenes[0].nodes.size(), model.meshes.size());
        for (double time = 0.05; time < 0.1 * frames; time += 0.1) {
            std::vector<int> shown;
            for (const auto& channel : model.animations[0].channels) {
                EXPECT_EQ(channel.target_path, "scale");
                const auto& sampler = model.animations[0].samplers[static_cast<std::size_t>(channel.sampler)];
                EXPECT_EQ(sampler.interpolation, "STEP");
                const auto times = values<float>(model, sampler.input);
                const auto scales = values<float>(model, sampler.output);
                ASSERT_EQ(scales.size(), 3 * times.size());
                ASSERT_EQ(times.front(), 0);
                std::size_t key = 0;
                while (key + 1 < times.size() && times[key + 1] <= time) ++key;
                if (scales[3 * key] == 1) shown.push_back(channel.target_node);
            }
            const int frame = static_cast<int>(time / 0.1);
            EXPECT_EQ(shown, frame == 1 ? std::vector<int>{} : std::vector<int>{frame == 0 ? 0 : frame - 1}) << time;
        }
        for (std::size_t node = 1; node < model.nodes.size(); ++node) {
            EXPECT_EQ(model.nodes[node].scale, (std::vector<double>{0, 0, 0}));
        }
        EXPECT_EQ(model.meshes[1].primitives.size(), 2u);
    }
}

TEST(ColouredAnimation, wrong_formats_results_and_rates_are_refused) {
    const Folder folder;
    EXPECT_EQ(error_of([&] { ColouredAnimation().write(folder / "a.ply"); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { ColouredAnimation().add(sample_mesh(), nullptr, {}); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { ColouredAnimation animation(0); }).code, ErrorCode::invalid_argument);
}

TEST(ColouredMesh, collisions_with_a_wrong_number_of_triangles_are_refused) {
    const Folder folder;
    const TriangleMesh mesh = sample_mesh();
    for (const char* const name : {"a.ply", "a.obj", "a.glb"}) {
        EXPECT_EQ(error_of([&] { write_coloured(folder / name, mesh, nullptr, {}); }).code,
                  ErrorCode::invalid_argument);
        EXPECT_EQ(error_of([&] { write_coloured(folder / name, mesh, &mesh, one_hit()); }).code,
                  ErrorCode::invalid_argument);
    }
    EXPECT_EQ(error_of([&] { write_coloured(folder / "a.stl", mesh, nullptr, one_hit()); }).code,
              ErrorCode::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace crumple::io::test
