// Tests of reading 3MF as worlds of bodies and as one mesh.

#include "3mf_file.h"

#include <array>
#include <sstream>

#include "files.h"

namespace crumple::io::test {
namespace {

using crumple::test::file_3mf;
using crumple::test::model_around;
using crumple::test::PackageParts;
using crumple::test::relationships;
using crumple::test::tetrahedron;

WorldMesh read_model(const std::string& children, const ReadOptions& options = {}) {
    const Folder folder;
    return read_world(folder.write("a.3mf", file_3mf(model_around(children))), options);
}

std::vector<std::string> body_names(const WorldMesh& world) {
    std::vector<std::string> names;
    for (const NamedBody& body : world.bodies) names.push_back(body.name);
    return names;
}

using BodyNames = std::vector<std::string>;
using PoseRows = std::array<double, 12>;

const std::string assembly = "<resources><object id=\"1\" name=\"part\">" + tetrahedron + R"(</object>
<object id="2"><components>
 <component objectid="1" transform="2 0 0 0 1 0 0 0 1 5 6 7"/><component objectid="1"/>
</components></object></resources>
<build><item objectid="2" transform="0 1 0 -1 0 0 0 0 1 1 2 3"/><item objectid="1"/></build>)";

TEST(ThreeMf, items_and_components_are_bodies_that_share_shapes) {
    const WorldMesh world = read_model(assembly);
    EXPECT_EQ(body_names(world), (BodyNames{"part", "part_2", "part_3"}));
    ASSERT_EQ(world.shapes.size(), 1u);
    EXPECT_EQ(world.shapes[0].precision(), ScalarType::float64);
    EXPECT_EQ(world.shapes[0].triangles, (std::vector<std::int32_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
    EXPECT_EQ(coordinates(world.shapes[0]), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}));
    // 3MF applies transforms to row vectors: first the component's (scale, translation), then the item's (x to y, y to
    // -x, translation). Poses are for column vectors.
    EXPECT_EQ(world.bodies[0].pose.rows, (PoseRows{0, -1, 0, -5, 2, 0, 0, 7, 0, 0, 1, 10}));
    EXPECT_EQ(world.bodies[1].pose.rows, (PoseRows{0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3}));
    EXPECT_EQ(world.bodies[2].pose, Pose{});
    EXPECT_TRUE(world.warnings.empty());
}

TEST(ThreeMf, mesh_holds_all_bodies_as_posed) {
    const TriangleMesh mesh = read_bytes(file_3mf(model_around(assembly)), "a.3mf");
    EXPECT_EQ(mesh.triangle_count(), 12);
    EXPECT_TRUE(mesh.groups.empty());
    const std::vector<double> xyz = coordinates(mesh);
    EXPECT_EQ(xyz, (std::vector<double>{-5, 7, 10, -5, 9, 10, -6, 7, 10, -5, 7, 11,  // part
                                        1,  2, 3,  1,  3, 3,  0,  2, 3,  1,  2, 4,   // part_2
                                        0,  0, 0,  1,  0, 0,  0,  1, 0,  0,  0, 1}));
}

TEST(ThreeMf, file_is_recognised_by_its_content) {
    const std::string bytes = file_3mf(model_around(assembly));
    EXPECT_EQ(read_bytes(bytes, "a.ply").triangle_count(), 12);
    std::istringstream in(bytes), again(bytes);
    EXPECT_EQ(read_world(in, "standard input").bodies.size(), 3u);
    EXPECT_EQ(read_mesh(again, "standard input").triangle_count(), 12);
}

TEST(ThreeMf, decimal_coordinates_are_rounded_to_the_nearest_number) {
    const std::string children = R"(<resources><object id="7"><mesh>
<vertices><vertex x=" 0.1 " y="+1e-400" z="-0"/><vertex x="0.1000000000000000055511151231257827" y="1E2" z=".5"/>
<vertex x="1" y="2" z="3"/></vertices><triangles><triangle v1="0" v2="1" v3="2" pid="9" p1="0"/></triangles>
</mesh></object></resources><build><item objectid="7"/></build>)";
    const WorldMesh world = read_model(children);
    EXPECT_EQ(body_names(world), BodyNames{"object 7"});
    EXPECT_EQ(coordinates(world.shapes.at(0)), (std::vector<double>{0.1, 0, -0.0, 0.1, 100, 0.5, 1, 2, 3}));
    EXPECT_TRUE(std::signbit(coordinates(world.shapes[0])[2]));
    const WorldMesh single = read_model(children, {.precision = Precision::float32});
    EXPECT_EQ(single.shapes.at(0).precision(), ScalarType::float32);
    EXPECT_EQ(coordinates(single.shapes[0])[0], double{0.1f});
}

TEST(ThreeMf, vertices_are_welded_only_on_request) {
    const std::string children = R"(<resources><object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/>
<vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="0"/></vertices>
<triangles><triangle v1="3" v2="1" v3="2"/></triangles></mesh></object></resources>
<build><item objectid="1"/></build>)";
    EXPECT_EQ(read_model(children).shapes.at(0).vertex_count(), 4);
    EXPECT_EQ(read_model(children, {.weld = Weld::yes}).shapes.at(0).vertex_count(), 3);
    std::string twice = children;
    twice.insert(twice.find("</build>"), "<item objectid=\"1\"/>");
    EXPECT_EQ(read_bytes(file_3mf(model_around(twice)), "a.3mf").vertex_count(), 8);
    EXPECT_EQ(read_bytes(file_3mf(model_around(twice)), "a.3mf", {.weld = Weld::yes}).vertex_count(), 3);
}

TEST(ThreeMf, components_can_name_objects_of_other_parts) {
    const std::string root = model_around(R"(<resources><object id="1" name="both"><components>
 <component p:path="/3D/Objects/a.model" objectid="1"/><component p:path="/3d/objects/A.model" objectid="2"/>
</components></object></resources><build p:UUID="x"><item objectid="1" p:UUID="y"/></build>)",
                                          "requiredextensions=\"p\" unit=\"inch\"");
    const std::string part = model_around("<resources><object id=\"1\">" + tetrahedron +
                                          "</object><object id=\"2\"><components><component objectid=\"1\"/>"
                                          "</components></object></resources><build/>");
    const Folder folder;
    const PackageParts parts{{"_rels/.rels", relationships}, {"3D/3dmodel.model", root}, {"3D/Objects/a.model", part}};
    const WorldMesh world = read_world(folder.write("a.3mf", parts.bytes()));
    EXPECT_EQ(body_names(world), (BodyNames{"both", "both_2"}));
    EXPECT_EQ(world.shapes.size(), 1u);
    EXPECT_EQ(world.warnings.size(), 1u);  // the other part has another unit
    for (const std::string& warning : world.warnings) EXPECT_TRUE(contains(warning, "a.3mf")) << warning;
}

TEST(ThreeMf, objects_outside_the_build_are_skipped_with_a_warning) {
    const std::string children = "<resources><object id=\"1\" type=\"support\">" + tetrahedron +
                                 "</object><object id=\"2\" type=\"other\">" + tetrahedron +
                                 "</object></resources><build><item objectid=\"1\"/></build>";
    const WorldMesh world = read_model(children);
    EXPECT_EQ(body_names(world), BodyNames{"object 1"});
    ASSERT_EQ(world.warnings.size(), 1u);
    EXPECT_TRUE(contains(world.warnings[0], "1 of its meshes are not in the build"));
    error_of([&] { read_model(children, {.strict = true}); });
    EXPECT_EQ(read_model("<resources/><build/>").warnings.size(), 1u);
}

TEST(ThreeMf, unsupported_extensions_are_skipped_but_refused_if_required) {
    const std::string extra = R"(xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02" )";
    std::string children = assembly;
    children.insert(children.find("</mesh>"),
                    "<b:beamlattice><triangles><triangle v1=\"99\"/></triangles>"
                    "</b:beamlattice>");
    const WorldMesh world = [&] {
        const Folder folder;
        return read_world(folder.write("a.3mf", file_3mf(model_around(children, extra))));
    }();
    EXPECT_EQ(world.triangle_count(), 12);
    ASSERT_EQ(world.warnings.size(), 1u);
    EXPECT_TRUE(contains(world.warnings[0], "beams"));
    expect_bad(file_3mf(model_around(children, extra + "requiredextensions=\"p b\"")), "a.3mf", Element::line, 2,
               "beamlattice/2017/02' is not supported");
    expect_bad(file_3mf(model_around(children, "requiredextensions=\"q\"")), "a.3mf", Element::line, 2, "'q'");
}

}  // namespace
}  // namespace crumple::io::test
