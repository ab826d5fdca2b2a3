// Tests of units of files: reading, preserving, writing and converting them.

#include <cmath>

#include "3mf_file.h"
#include "files.h"
#include "gltf_scene.h"

namespace crumple::io::test {
namespace {

constexpr Unit units[] = {Unit::micrometre, Unit::millimetre, Unit::centimetre, Unit::inch, Unit::foot, Unit::metre};

TriangleMesh corner(Unit unit, double size = 1) {
    TriangleMesh mesh{std::vector<double>{0, 0, 0, size, 0, 0, 0, size, 0}, {0, 1, 2}};
    mesh.unit = unit;
    return mesh;
}

TEST(Unit, unit_is_read_from_3mf_and_is_metres_for_gltf) {
    const Folder folder;
    const auto read = [&](const std::string& attributes) {
        const std::string model =
            crumple::test::model_around("<resources><object id=\"1\">" + crumple::test::tetrahedron +
                                            "</object></resources><build><item objectid=\"1\"/></build>",
                                        attributes);
        const fs::path path = folder.write("a.3mf", crumple::test::file_3mf(model));
        EXPECT_EQ(read_mesh(path).unit, read_world(path).unit);
        EXPECT_EQ(read_world(path).shapes[0].unit, read_world(path).unit);
        return read_mesh(path).unit;
    };
    EXPECT_EQ(read(""), Unit::millimetre);
    EXPECT_EQ(read("unit=\"micron\""), Unit::micrometre);
    EXPECT_EQ(read("unit=\"inch\""), Unit::inch);
    EXPECT_EQ(read("unit=\"foot\""), Unit::foot);
    EXPECT_EQ(error_of([&] { read("unit=\"mm\""); }).code, ErrorCode::format);
    const fs::path glb = folder.write("a.glb", crumple::test::robot_scene().glb());
    EXPECT_EQ(read_world(glb).unit, Unit::metre);
    EXPECT_EQ(read_mesh(glb).unit, Unit::metre);
    EXPECT_EQ(read_bytes("OFF\n0 0 0\n", "a.off").unit, Unit::unknown);
}

TEST(Unit, unit_is_kept_by_3mf_and_converted_to_metres_by_gltf) {
    const Folder folder;
    for (const Unit unit : units) {
        SCOPED_TRACE(name_of(unit));
        const TriangleMesh mesh = corner(unit, 3);
        write_mesh(folder / "a.3mf", mesh);
        const TriangleMesh back = read_mesh(folder / "a.3mf");
        EXPECT_EQ(back.unit, unit);
        expect_same(back, mesh);

        write_mesh(folder / "a.glb", mesh);
        TriangleMesh metres = mesh;
        convert_unit(metres, Unit::metre);
        const TriangleMesh scaled = read_mesh(folder / "a.glb", {.precision = Precision::float64});
        EXPECT_EQ(scaled.unit, Unit::metre);
        EXPECT_DOUBLE_EQ(coordinates(scaled)[3], coordinates(metres)[3]);
    }
    Intersections free;
    free.hit.assign(1, 0);
    for (const char* const name : {"a.3mf", "a.glb"}) {
        write_coloured(folder / name, corner(Unit::inch, 10), nullptr, free);
        const TriangleMesh back = read_mesh(folder / name, {.precision = Precision::float64, .unit = Unit::millimetre});
        EXPECT_EQ(coordinates(back)[3], 254) << name;
    }
    write_mesh(folder / "none.3mf", corner(Unit::unknown));
    EXPECT_EQ(read_mesh(folder / "none.3mf").unit, Unit::millimetre);
    write_mesh(folder / "none.glb", corner(Unit::unknown));
    EXPECT_EQ(coordinates(read_mesh(folder / "none.glb"))[3], 1);
}

TEST(Unit, conversion_rounds_once) {
    const double exact[] = {1e-6, 1e-3, 1e-2, 0.0254, 0.3048, 1};  // metres, each the nearest float64
    for (std::size_t i = 0; i < std::size(units); ++i) {
        TriangleMesh mesh = corner(units[i]);
        convert_unit(mesh, Unit::metre);
        EXPECT_EQ(coordinates(mesh)[3], exact[i]) << name_of(units[i]);
        EXPECT_EQ(mesh.unit, Unit::metre);
    }
    // Compares lengths that are converted from inches to millimetres with the exact products by 127/5, in integer
    // arithmetic.
    std::uint64_t random = 1;
    for (int i = 0; i < 10'000; ++i) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const auto whole =
            static_cast<std::int64_t>(random >> 12 | std::uint64_t{1} << 52);  // so that the result is an integer, too
        TriangleMesh mesh = corner(Unit::inch, static_cast<double>(whole));
        convert_unit(mesh, Unit::millimetre);
        const __int128 product = static_cast<__int128>(whole) * 127;
        const double found = coordinates(mesh)[3];
        // The error is at most half a unit in the last place. `error` is five times the error, an integer.
        const auto error = static_cast<double>(static_cast<__int128>(found) * 5 - product);
        const double last = std::nextafter(found, INFINITY) - found;
        EXPECT_LE(2 * std::abs(error), 5 * last) << whole;
    }
}

TEST(Unit, conversion_of_float32_rounds_to_float32) {
    TriangleMesh mesh{std::vector<float>{0, 0, 0, 0.1f, 0, 0, 0, 4.7f, 0}, {0, 1, 2}};
    mesh.unit = Unit::inch;
    convert_unit(mesh, Unit::millimetre);
    EXPECT_EQ(std::get<0>(mesh.vertices)[3], static_cast<float>(double{0.1f} * 127 / 5));
    // Truncation and float32 arithmetic would give 0x1.dd851cp+6.
    EXPECT_EQ(std::get<0>(mesh.vertices)[7], 0x1.dd851ep+6f);
}

TEST(Unit, conversion_of_a_world_scales_shapes_and_translations) {
    WorldMesh world;
    world.shapes = {corner(Unit::inch)};
    world.bodies = {{"a"}, {"b", 0, {{0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30}}}};
    world.unit = Unit::inch;
    const TriangleMesh before = posed_mesh(world);
    EXPECT_EQ(before.unit, Unit::inch);
    convert_unit(world, Unit::millimetre);
    EXPECT_EQ(world.unit, Unit::millimetre);
    EXPECT_EQ(world.shapes[0].unit, Unit::millimetre);
    EXPECT_EQ(world.bodies[1].pose, (Pose{{0, -1, 0, 254, 1, 0, 0, 508, 0, 0, 1, 762}}));
    TriangleMesh converted = before;
    convert_unit(converted, Unit::millimetre);
    EXPECT_EQ(coordinates(posed_mesh(world)), coordinates(converted));
}

TEST(Unit, unit_can_be_stated_without_changing_coordinates) {
    const Folder folder;
    const fs::path path = folder.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    const TriangleMesh stated = read_mesh(path, {.unit = Unit::inch});
    EXPECT_EQ(stated.unit, Unit::inch);
    EXPECT_EQ(coordinates(stated), coordinates(read_mesh(path)));
    EXPECT_EQ(read_world(path, {.unit = Unit::inch}).shapes[0].unit, Unit::inch);
}

TEST(Unit, failed_conversion_changes_nothing) {
    TriangleMesh large = corner(Unit::metre, 1e307);
    const Error error = error_of([&] { convert_unit(large, Unit::micrometre); });
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_EQ(error.element, Element::vertex);
    EXPECT_EQ(error.index, 1);
    EXPECT_EQ(error_of([&] { convert_unit(large, Unit::unknown); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(large.unit, Unit::metre);
    expect_same(large, corner(Unit::metre, 1e307));

    WorldMesh world;
    world.shapes = {corner(Unit::metre), corner(Unit::metre, 1e307)};
    world.unit = Unit::metre;
    EXPECT_EQ(error_of([&] { convert_unit(world, Unit::micrometre); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(world.unit, Unit::metre);
    expect_same(world.shapes[0], corner(Unit::metre));
    expect_same(world.shapes[1], corner(Unit::metre, 1e307));
    for (const TriangleMesh& shape : world.shapes) EXPECT_EQ(shape.unit, Unit::metre);
    const Pose far{{1, 0, 0, 1e307, 0, 1, 0, 0, 0, 0, 1, 0}};
    world.shapes[1] = corner(Unit::metre);
    world.bodies = {{"near"}, {"far", 1, far}};
    EXPECT_EQ(error_of([&] { convert_unit(world, Unit::micrometre); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(world.unit, Unit::metre);
    EXPECT_EQ(world.bodies[1].pose, far);
    for (const TriangleMesh& shape : world.shapes) expect_same(shape, corner(Unit::metre));

    const Folder folder;
    Intersections free;
    free.hit.assign(1, 0), free.hit_second.assign(1, 0);
    const TriangleMesh inch = corner(Unit::inch), metre = corner(Unit::metre);
    EXPECT_TRUE(contains(error_of([&] { write_coloured(folder / "a.ply", inch, &metre, free); }).what(),
                         "the meshes are in different units, in and m"));
}

TEST(Unit, each_unit_has_a_name_and_other_names_are_refused) {
    for (const Unit unit : units) EXPECT_EQ(unit_named(name_of(unit)), unit);
    EXPECT_EQ(unit_named("millimeter"), Unit::millimetre);
    EXPECT_EQ(unit_named("metre"), Unit::metre);
    EXPECT_STREQ(name_of(Unit::unknown), "unknown");
    EXPECT_EQ(error_of([] { unit_named("unknown"); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([] { unit_named("mile"); }).code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace crumple::io::test
