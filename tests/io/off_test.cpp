#include "samples.h"

namespace crumple::io::test {
namespace {

const std::string body = "3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const TriangleMesh one_triangle{std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, {}};

TEST(Off, header_can_have_prefixes_or_be_missing) {
    for (const char* const header :
         {"OFF\n", "OFF ", "COFF\n", "NOFF\n", "CNOFF\n", "STOFF\n", "STCNOFF ", "", "# comment\nOFF\n\n# comment\n",
          "OFF # comment\n", "NCOFF\n", "CNSTOFF\n", "OFF", "COFF"}) {
        SCOPED_TRACE(header);
        expect_same(read_bytes(header + body, "a.off"), one_triangle);
    }
}

TEST(Off, count_of_edges_is_optional) {
    expect_same(read_bytes("OFF\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off"), one_triangle);
}

TEST(Off, colours_normals_and_texture_coordinates_are_skipped) {
    expect_same(read_bytes("STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255 .5 .5\n1 0 0 0 0 1\n0 1 0 # corner\n"
                           "3 0 1 2 0.5 0.5 0.5 # face\n",
                           "a.off"),
                one_triangle);
}

TEST(Off, convex_polygon_is_fanned_from_its_first_corner) {
    EXPECT_EQ(read_bytes("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 3 0 1 2\n", "a.off").triangles,
              (std::vector<std::int32_t>{3, 0, 1, 3, 1, 2}));
}

TEST(Off, face_can_span_several_lines) {
    EXPECT_EQ(read_bytes("OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 # half\n\n3 2 255 0 0\n3\n0 1\n2 1\n", "a.off")
                  .triangles,
              (std::vector<std::int32_t>{0, 1, 3, 0, 3, 2, 0, 1, 2}));
}

TEST(Off, faces_with_fewer_than_three_corners_give_a_warning) {
    const std::string text = "OFF\n3 4 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n1 0\n0\n";
    const TriangleMesh mesh = read_bytes(text, "a.off");
    EXPECT_EQ(mesh.triangles, one_triangle.triangles);
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_TRUE(contains(mesh.warnings[0],
                         "a.off, line 7: a face has fewer than three corners and is left out, and 2 more like that"))
        << mesh.warnings[0];
    expect_bad(text, "a.off", Element::line, 7, "fewer than three corners", {.strict = true});
}

TEST(Off, error_names_the_line) {
    const auto bad = [](const std::string& text, std::int64_t line, const char* what) {
        SCOPED_TRACE(text);
        expect_bad(text, "a.off", Element::line, line, what);
    };
    bad("4OFF\n" + body, 1, "three dimensions");
    bad("OFF BINARY\n", 1, "binary");
    bad("OOFF\n" + body, 1, "'OOFF'");
    bad("OFF\n", 2, "count of vertices");
    bad("OFF\n3\n0 0 0\n1 0 0\n0 1 0\n", 2, "faces is missing");
    bad("OFF\n3 1 0 0 0 0\n", 2, "do not fit");
    bad("OFF\n3 1 0 0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 2, "more than three numbers");
    bad("OFF\n-3 1 0\n", 2, "-3 vertices");
    bad("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 7, "a face is missing");
    bad("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 4, "a number is missing");
    bad("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6, "vertex 3 of 3");
    bad("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-1 0 1\n", 6, "-1 corners");
    bad("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 7, "a corner is missing");
    bad("OFFICE\n" + body, 1, "'OFFICE'");
    bad("XOFF\n" + body, 1, "'XOFF'");
    bad("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", 7, "data follows");
}

}  // namespace
}  // namespace crumple::io::test
