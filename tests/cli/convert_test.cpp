// Tests of crumple convert: the output holds everything of the input that its format can hold.

#include "3mf_file.h"
#include "crumple/io.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

using Convert = Cli;

constexpr std::string_view quad_and_triangle = "v 0 0 0\nv 0.1 0 0\nv 0.1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\n";

double second_x(const io::TriangleMesh& mesh) {
    return std::visit([](const auto& xyz) { return double{xyz[3]}; }, mesh.vertices);
}

void expect_same(const io::TriangleMesh& mesh, const io::TriangleMesh& other) {
    EXPECT_EQ(mesh.vertices, other.vertices);
    EXPECT_EQ(mesh.triangles, other.triangles);
    EXPECT_EQ(mesh.polygons.offsets, other.polygons.offsets);
    EXPECT_EQ(mesh.polygons.corners, other.polygons.corners);
}

TEST_F(Convert, polygons_and_exact_coordinates_are_kept_in_ply_off_and_obj) {
    write("a.obj", quad_and_triangle);
    const io::TriangleMesh original = io::read_mesh(file("a.obj"));
    ASSERT_EQ(original.polygons.count(), 2);
    for (const char* const name : {"b.ply", "b.off", "b.obj"}) {
        EXPECT_EQ(crumple(std::string("convert a.obj ") + name).status, 0) << name;
        expect_same(io::read_mesh(file(name)), original);
    }
    EXPECT_EQ(crumple("convert b.ply c.off").status, 0);
    EXPECT_EQ(read("c.off"), "OFF\n5 2 0\n0 0 0\n0.1 0 0\n0.1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n");
}

TEST_F(Convert, stl_output_holds_float32_and_refuses_overflow) {
    write("a.obj", quad_and_triangle);
    EXPECT_EQ(crumple("convert a.obj a.stl").status, 0);
    const io::TriangleMesh stl = io::read_mesh(file("a.stl"));
    EXPECT_EQ(stl.triangle_count(), 3);
    EXPECT_EQ(stl.precision(), ScalarType::float32);
    EXPECT_EQ(second_x(stl), double{0.1f});
    write("far.obj", "v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Outcome refused = crumple("convert far.obj far.stl");
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(is_error_line(refused.err) && contains(refused.err, "overflows float32")) << refused.err;
    EXPECT_FALSE(fs::exists(file("far.stl")));
}

TEST_F(Convert, vertices_are_welded_on_request) {
    write("a.off", "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 3 5 4\n");
    EXPECT_EQ(crumple("convert a.off apart.ply").status, 0);
    EXPECT_EQ(io::read_mesh(file("apart.ply")).vertex_count(), 6);
    EXPECT_EQ(crumple("convert --weld a.off one.ply").status, 0);
    EXPECT_EQ(io::read_mesh(file("one.ply")).vertex_count(), 4);
}

TEST_F(Convert, meshes_can_be_converted_in_a_pipe) {
    write("a.obj", quad_and_triangle);
    EXPECT_EQ(crumple("convert a.obj a.off").status, 0);
    EXPECT_EQ(shell("$crumple convert - - --format ply < a.obj | $crumple convert - - --format off").out,
              read("a.off"));
}

TEST_F(Convert, translation_of_a_scene_node_is_applied) {
    write("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [1, 2, 4]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36,
            "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    const Outcome outcome = crumple("convert a.gltf a.off");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(read("a.off"), "OFF\n3 1 0\n1 2 4\n2 2 4\n1 3 4\n3 0 1 2\n");
}

TEST_F(Convert, bodies_are_kept_in_3mf) {
    io::WorldMesh world;
    world.shapes = {{std::vector<double>{0, 0, 0, 1, 0, 0, 0, 0.1, 0}, {0, 1, 2}}};
    world.bodies = {{"base", 0}, {"arm", 0, {{1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 4}}}};
    io::write_world(file("a.3mf"), world);
    EXPECT_EQ(crumple("convert a.3mf b.3mf.gz").status, 0);
    EXPECT_EQ(shell("cat b.3mf.gz | $crumple convert - - --format 3mf > c.3mf").status, 0);
    EXPECT_EQ(read("c.3mf"), read("a.3mf"));
    const io::WorldMesh again = io::read_world(file("c.3mf"));
    ASSERT_EQ(again.bodies.size(), 2u);
    EXPECT_EQ(again.shapes.size(), 1u);
    EXPECT_EQ(again.bodies[1].name, "arm");
    EXPECT_EQ(again.bodies[1].pose, world.bodies[1].pose);
    EXPECT_EQ(crumple("convert c.3mf a.off").status, 0);
    EXPECT_EQ(read("a.off"), "OFF\n6 2 0\n0 0 0\n1 0 0\n0 0.1 0\n1 2 4\n2 2 4\n1 2.1 4\n3 0 1 2\n3 3 4 5\n");
    EXPECT_TRUE(contains(crumple("info c.3mf").out, "arm"));
    EXPECT_EQ(crumple("detect c.3mf --groups bodies -o hits.3mf -o hits.csv.gz").status, 0);
    EXPECT_EQ(io::read_world(file("hits.3mf")).bodies.size(), 2u);
    EXPECT_TRUE(read("hits.csv.gz").starts_with("\x1f\x8b"));
}

TEST_F(Convert, gz_extension_compresses_the_file) {
    write("a.obj", quad_and_triangle);
    EXPECT_EQ(crumple("convert a.obj a.ply.gz").status, 0);
    expect_same(io::read_mesh(file("a.ply.gz")), io::read_mesh(file("a.obj")));
    EXPECT_EQ(crumple("convert a.obj b.ply").status, 0);
    EXPECT_TRUE(shell("gzip -dc a.ply.gz | cmp - b.ply").status == 0);
    EXPECT_EQ(shell("gzip -c a.obj > a.obj.gz; $crumple detect a.obj.gz -o c.obj.gz -o pairs.txt.gz").status, 0);
    EXPECT_TRUE(fs::exists(file("c.mtl")));
    EXPECT_EQ(crumple("verify a.obj pairs.txt.gz").status, 0);
    EXPECT_EQ(crumple("sequence a.obj a.obj.gz -o frame.ply.gz -o times.csv.gz").status, 0);
    EXPECT_TRUE(fs::exists(file("frame0.ply.gz")) && fs::exists(file("frame1.ply.gz")));
    write("a.gz", "x");
    EXPECT_EQ(crumple("convert a.obj a.gz").status, 2);
}

TEST_F(Convert, unit_is_kept_or_converted) {
    write("inch.3mf", crumple::test::file_3mf(
                          crumple::test::model_around("<resources><object id=\"1\">" + crumple::test::tetrahedron +
                                                          "</object></resources><build><item objectid=\"1\"/></build>",
                                                      "unit=\"inch\"")));
    EXPECT_EQ(crumple("convert inch.3mf back.3mf").err, "4 triangles to back.3mf, unit in\n");
    expect_same(io::read_mesh(file("back.3mf")), io::read_mesh(file("inch.3mf")));
    EXPECT_EQ(io::read_mesh(file("back.3mf")).unit, io::Unit::inch);
    EXPECT_EQ(crumple("convert inch.3mf mm.3mf --unit mm").status, 0);
    EXPECT_EQ(second_x(io::read_mesh(file("mm.3mf"))), 25.4);
    EXPECT_EQ(crumple("convert inch.3mf metres.glb").status, 0);
    EXPECT_EQ(static_cast<float>(second_x(io::read_mesh(file("metres.glb")))), 0.0254f);
    EXPECT_EQ(crumple("detect inch.3mf -o coloured.3mf").status, 0);
    EXPECT_EQ(io::read_mesh(file("coloured.3mf")).unit, io::Unit::inch);

    const Outcome two = crumple("detect mm.3mf inch.3mf");
    EXPECT_TRUE(contains(two.err, "crumple: note: inch.3mf is converted from in to mm, the unit of mm.3mf")) << two.err;
    EXPECT_NE(two.out, "");
    const Outcome rest = crumple("near mm.3mf --radius 1 --rest inch.3mf");
    EXPECT_TRUE(contains(rest.err, "inch.3mf is converted from in to mm, the unit of mm.3mf")) << rest.err;
    EXPECT_EQ(crumple("convert inch.3mf plain.off").status, 0);
    const std::string warning = "crumple: warning: plain.off states no unit, and inch.3mf states in:";
    EXPECT_TRUE(contains(crumple("detect inch.3mf plain.off").err, warning));
    EXPECT_TRUE(contains(crumple("detect plain.off inch.3mf --groups bodies").err, warning));
    EXPECT_EQ(crumple("detect inch.3mf plain.off --strict").status, 2);
    EXPECT_FALSE(contains(crumple("detect inch.3mf plain.off --unit in").err, "unit"));
    EXPECT_FALSE(contains(crumple("detect plain.off plain.off").err, "unit"));
    EXPECT_TRUE(contains(crumple("info inch.3mf").out, "unit                  in\n"));
    EXPECT_EQ(crumple("convert inch.3mf x.3mf --unit miles").status, 2);
}

TEST_F(Convert, unknown_statements_of_obj_give_a_warning) {
    write("a.obj", std::string(quad_and_triangle) + "hello 1\n");
    EXPECT_TRUE(contains(crumple("convert a.obj a.ply").err, "'hello'"));
    EXPECT_EQ(crumple("convert --strict a.obj b.ply").status, 2);
    EXPECT_FALSE(fs::exists(file("b.ply")));
}

TEST_F(Convert, wrong_inputs_and_outputs_are_refused) {
    write("a.obj", quad_and_triangle);
    const auto expect_refused = [&](const std::string& arguments, const std::string& reason) {
        const Outcome outcome = crumple("convert " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_TRUE(is_error_line(outcome.err) && contains(outcome.err, reason)) << outcome.err;
    };
    for (const char* const name : {"a.html", "a.txt", "a"})
        expect_refused(std::string("a.obj ") + name, ".ply, .obj, .stl, .off, .glb or .3mf");
    expect_refused("a.obj - --format html", ".ply, .obj, .stl, .off, .glb or .3mf");
    expect_refused("a.obj -", "--format");
    expect_refused("a.obj b.ply --format ply", "--format");
    expect_refused("a.obj ./a.obj", "a.obj is the input; choose another name");
    expect_refused("missing.obj b.ply", "missing.obj");
    expect_refused("a.obj", "OUT");
    EXPECT_EQ(read("a.obj"), quad_and_triangle);
}

}  // namespace
}  // namespace crumple::cli::test
