#include "samples.h"

namespace crumple::io::test {
namespace {

const std::string four = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

std::vector<std::int32_t> triangles(const std::string& text) { return read_bytes(text, "a.obj").triangles; }

using Indices = std::vector<std::int32_t>;

TEST(Obj, corners_can_name_texture_coordinates_and_normals) {
    EXPECT_EQ(triangles(four + "f 1/1 2/2 3/3\nf 1//1 2//2 3//3\nf 1/1/1 3/2/2 4/3/3\nf 1/-1/-1 2/-2 3\n"),
              (Indices{0, 1, 2, 0, 1, 2, 0, 2, 3, 0, 1, 2}));
}

TEST(Obj, negative_indices_count_back_from_the_last_vertex) {
    EXPECT_EQ(triangles("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -1 -2\n"), (Indices{0, 1, 2, 0, 3, 2}));
}

TEST(Obj, face_can_name_a_later_vertex) {
    EXPECT_EQ(triangles("f 1 2 3\n" + four), (Indices{0, 1, 2}));
    expect_bad("\nf 1 2 5\n" + four, "a.obj", Element::line, 2, "vertex 5 of 4");
}

TEST(Obj, convex_polygons_are_fanned_from_their_first_corner) {
    EXPECT_EQ(triangles(four + "v 1 1 0\nf 2 5 3 1\n"), (Indices{1, 4, 2, 1, 2, 0}));
}

TEST(Obj, obj_objects_and_groups_are_not_read_as_groups) {
    EXPECT_TRUE(read_bytes("o a\n" + four + "g b\nf 1 2 3\n", "a.obj").groups.empty());
}

TEST(Obj, backslash_continues_a_line) {
    EXPECT_EQ(triangles(four + "f 1 \\\n2 \\\r\n3\nf 1\\\n 2 3\n"), (Indices{0, 1, 2, 0, 1, 2}));
    EXPECT_EQ(triangles("v 0 \\\n 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\\\nf 1 2 3\nf 1 2 3\n").size(), 3u)
        << "a skipped statement takes its continuation with it";
}

TEST(Obj, lines_and_points_are_read_on_request) {
    const ReadOptions options{.lines_and_points = true};
    expect_bad("v 0 0 0\nl 1 2/7 -1\n" + four + "l 9 1\n", "a.obj", Element::line, 7, "a line names vertex 9 of 5",
               options);
    const TriangleMesh mesh = read_bytes("l 1 2/7 3\np 4\n" + four + "l 4 1\np 1 -1\nf 1 2 3\n", "a.obj", options);
    EXPECT_EQ(mesh.lines, (std::vector<Edge>{{0, 1}, {1, 2}, {3, 0}}));
    EXPECT_EQ(mesh.points, (Indices{3, 0, 3}));
    const MeshFeatures all = features_of(mesh);
    EXPECT_EQ(all.edges, (std::vector<Edge>{{0, 1}, {0, 2}, {0, 3}, {1, 2}}));
    EXPECT_EQ(all.points, (Indices{0, 1, 2, 3}));
    const TriangleMesh skipped = read_bytes(four + "l 9\np\nf 1 2 3\n", "a.obj");
    EXPECT_TRUE(skipped.lines.empty() && skipped.points.empty());
    expect_bad(four + "l 1\n", "a.obj", Element::line, 5, "a line has fewer than two vertices", options);
    expect_bad(four + "l 1 2 2\n", "a.obj", Element::line, 5, "a line names a vertex twice in succession", options);
    expect_bad(four + "p\n", "a.obj", Element::line, 5, "a point names no vertex", options);
    expect_bad(four + "p 0\n", "a.obj", Element::line, 5, "a point names vertex 0 of 4", options);
    expect_bad(four + "l 1 2x\n", "a.obj", Element::line, 5, "a line's corner must be v, v/vt", options);
    const TriangleMesh welded =
        read_bytes(four + "v 1 0 0\nl 1 5\nl 2 5\np 5\n", "a.obj", {.weld = Weld::yes, .lines_and_points = true});
    EXPECT_EQ(welded.lines, (std::vector<Edge>{{0, 1}}));
    EXPECT_EQ(welded.points, (Indices{1, 1})) << "what is left of a line";
}

TEST(Obj, comment_ends_with_its_line) {
    EXPECT_EQ(triangles("# C:\\\n" + four + "f 1 2 4 # 3\n#f 1 2 3\n   # f 1 2 3\n"), (Indices{0, 1, 3}));
}

TEST(Obj, further_components_of_a_vertex_are_skipped) {
    const auto mesh = read_bytes("v 1 2 3 4\nv 1 2 3 .1 .2 .3\nv\t1  2 3\t\nv 1 2 3 1 .1 .2 .3\nf 1 2 3", "a.obj");
    EXPECT_EQ(coordinates(mesh), (std::vector<double>{1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}));
}

TEST(Obj, texture_and_normal_indices_of_a_corner_can_be_empty) {
    EXPECT_EQ(triangles(four + "f 1/ 2// 3/1/\nf 1//1 2/-1 3/1/-1\n"), (Indices{0, 1, 2, 0, 1, 2}));
}

TEST(Obj, faces_with_fewer_than_three_corners_give_a_warning) {
    const std::string text = four + "f 1 2 3\nf 1 2\nf\nf 1 2 3 4\nf 4\n";
    const TriangleMesh mesh = read_bytes(text, "a.obj");
    EXPECT_EQ(mesh.triangles, (Indices{0, 1, 2, 0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(mesh.polygons.corners, (Indices{0, 1, 2, 0, 1, 2, 3}));
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_TRUE(contains(mesh.warnings[0],
                         "a.obj, line 6: a face has fewer than three corners and is left out, and 2 more like that"))
        << mesh.warnings[0];
    expect_bad(text, "a.obj", Element::line, 6, "fewer than three corners", {.strict = true});
}

TEST(Obj, error_names_the_line) {
    const auto bad = [](const std::string& text, std::int64_t line, const char* what) {
        SCOPED_TRACE(text);
        expect_bad(four + text, "a.obj", Element::line, line, what);
    };
    bad("f 0 1 2\n", 5, "vertex 0 of 4");
    bad("f 1 2 -5\n", 5, "vertex -5 of 4");
    bad("f 1 2 5\n", 5, "vertex 5 of 4");
    bad("f 1 2 99999999999\n", 5, "99999999999");
    bad("f 1 2 99999999999999999999999\n", 5, "too large");
    bad("f 1 2 x\n", 5, "'x' is not a vertex index");
    bad("f 1 2 3x\n", 5, "v/vt/vn");
    bad("f 1 2 3/x\n", 5, "v/vt/vn");
    bad("f 1 2 3-1\n", 5, "v/vt/vn");
    bad("f 1 2 1.5\n", 5, "v/vt/vn");
    bad("v 1 2\n", 5, "a number is missing");
    bad("v 1 2 \n3\n", 5, "a number is missing");
    bad("v 1 2 nan\n", 5, "'nan'");
    for (const char* const large :
         {"1e9223372036854775807", "10e9223372036854775807", "1e99999999999999999999", "1e309"})
        bad("v " + std::string(large) + " 0 0\n", 5, "overflows float64");
    bad("v 1 2 3 4 5\n", 5, "a vertex has 5 numbers");
    bad("v 1 2 3 4 5 6 7 8\n", 5, "a vertex has 8 numbers");
    bad("v 1 2 3 red\n", 5, "'red' is not a finite number");
    bad("f 1/- 2 3\n", 5, "v/vt/vn");
    bad("f 1/// 2 3\n", 5, "v/vt/vn");
    bad("f 1/2/3/4 2 3\n", 5, "v/vt/vn");
    bad("f 1 2 3\n4\n", 6, "'4' is not a statement");
    bad("\x1b[2J\n", 5, "'?[2J' is not a statement");
    bad("surf 0 1 0 1 1 2 3 4\n", 5, "'surf': free-form surfaces are not supported");
}

TEST(Obj, unknown_statements_are_skipped_with_one_warning) {
    const std::string text = four + "seam 1 2\nf 1 2 3\npart_2 x\nseam 3 4\n";
    const TriangleMesh mesh = read_bytes(text, "a.obj");
    EXPECT_EQ(mesh.triangles, (Indices{0, 1, 2}));
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_NE(mesh.warnings[0].find("a.obj, line 5: the unknown statement 'seam' is skipped, and 2 more like that"),
              std::string::npos)
        << mesh.warnings[0];
    expect_bad(text, "a.obj", Element::line, 5, "the unknown statement 'seam'", {.strict = true});
    expect_bad("hello world\nf 1 2 3\n", "a.obj", Element::line, 2, "vertex 3 of 0");
    expect_bad("\nhello world\n", "a.obj", Element::line, 2, "'hello' is not a statement of an OBJ file");
}

TEST(Obj, points_and_lines_are_no_triangles) {
    EXPECT_EQ(triangles(four + "p 1\nl 1 2\ns off\nusemtl x\nvt 0 0\nvp 0 0\nf 1 2 3\n"), (Indices{0, 1, 2}));
}

TEST(Obj, file_without_faces_gives_vertices_but_no_triangles) {
    EXPECT_EQ(read_bytes(four, "a.obj").vertex_count(), 4);
    EXPECT_EQ(read_bytes(four, "a.obj").triangle_count(), 0);
}

}  // namespace
}  // namespace crumple::io::test
