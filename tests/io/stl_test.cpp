#include <algorithm>
#include <cmath>

#include "samples.h"

namespace crumple::io::test {
namespace {

TEST(Stl, stl_is_welded_unless_welding_is_turned_off) {
    for (const std::string& bytes : {binary_stl(), ascii_stl()}) {
        EXPECT_EQ(read_bytes(bytes, "a.stl").vertex_count(), 5);
        const TriangleMesh soup = read_bytes(bytes, "a.stl", {.weld = Weld::no});
        EXPECT_EQ(soup.vertex_count(), 9);
        EXPECT_EQ(soup.triangles, (std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
    }
}

TEST(Stl, binary_file_can_begin_with_solid) {
    const std::string bytes = binary_stl();
    ASSERT_EQ(bytes.substr(0, 5), "solid");
    EXPECT_EQ(read_bytes(bytes, "a.stl").precision(), ScalarType::float32);
}

TEST(Stl, several_solids_are_one_mesh) { EXPECT_EQ(read_bytes(ascii_stl(), "a.stl").triangle_count(), 3); }

TEST(Stl, keywords_can_be_in_upper_case) {
    std::string upper = ascii_stl();
    for (char& c : upper) c = static_cast<char>(std::toupper(c));
    expect_same(read_bytes(upper, "a.stl"), read_bytes(ascii_stl(), "a.stl"));
}

TEST(Stl, empty_solid_has_no_triangles) {
    EXPECT_EQ(read_bytes("solid nothing at all\nendsolid nothing at all\n", "a.stl").triangle_count(), 0);
    EXPECT_EQ(read_bytes(std::string(84, '\0'), "a.stl").triangle_count(), 0);
}

TEST(Stl, bytes_after_the_triangles_are_skipped_with_a_warning) {
    for (std::string bytes : {binary_stl() + "x", binary_stl() + std::string(1000, '\0')}) {
        for (const char* const title : {"solid", "other"}) {
            bytes.replace(0, 5, title);
            const TriangleMesh mesh = read_bytes(bytes, "a.stl");
            expect_same(mesh, read_bytes(binary_stl(), "a.stl"));
            ASSERT_EQ(mesh.warnings.size(), 1u);
            const std::string skipped =
                "byte 234: " + std::to_string(bytes.size() - 234) + " bytes after the triangles";
            EXPECT_NE(mesh.warnings[0].find(skipped), std::string::npos) << mesh.warnings[0];
            expect_bad(bytes, "a.stl", Element::byte, 234, "bytes after the triangles", {.strict = true});
        }
    }
}

TEST(Stl, file_shorter_than_its_triangles_is_an_error) {
    std::string bytes = binary_stl().substr(0, 200);
    expect_bad(bytes, "a.stl", Element::byte, 80, "too short for the triangles announced here");
    bytes.replace(0, 5, "other");
    expect_bad(bytes, "a.stl", Element::byte, 80, "too short for the triangles announced here");
    expect_bad(std::string(20, '\0'), "a.stl", Element::byte, 20, "too short");
}

TEST(Stl, error_of_a_nonfinite_coordinate_names_the_byte) {
    std::string bytes = binary_stl();
    bytes.replace(84 + 50 + 12 + 8, 4, packed(std::endian::little, std::nanf("")));
    expect_bad(bytes, "a.stl", Element::byte, 84 + 50 + 12 + 8, "not finite");
}

TEST(Stl, normals_and_attributes_are_ignored) {
    std::string bytes = binary_stl();
    bytes.replace(84, 4, packed(std::endian::little, std::nanf("")));
    bytes.replace(84 + 48, 2, "ab");
    expect_same(read_bytes(bytes, "a.stl"), read_bytes(binary_stl(), "a.stl"));
}

TEST(Stl, missing_end_of_a_solid_gives_a_warning) {
    const std::string whole = ascii_stl(), cut = whole.substr(0, whole.rfind("endsolid"));
    const TriangleMesh mesh = read_bytes(cut, "a.stl");
    EXPECT_EQ(coordinates(mesh), coordinates(read_bytes(whole, "a.stl")));
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_NE(mesh.warnings[0].find("endsolid is missing: the file may have lost its end"), std::string::npos);
    expect_bad(cut, "a.stl", Element::line, std::count(cut.begin(), cut.end(), '\n') + 1, "endsolid is missing",
               {.strict = true});
}

TEST(Stl, end_keywords_can_hold_a_blank_and_further_words_are_skipped) {
    const std::string text =
        "solid c\ncolor 0.1 0.2 0.3\nfacet normal 0 0 1 # up\n outer loop 1\n  vertex 0 0 0 red\n  vertex 1 0 0\n"
        "  color 1 0 0\n  vertex 0 1 0\n END LOOP of it\nend facet\nend solid c\nfurther\n";
    const TriangleMesh mesh = read_bytes(text.substr(0, text.rfind("further")), "a.stl");
    EXPECT_EQ(coordinates(mesh), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    EXPECT_TRUE(mesh.warnings.empty());
    expect_bad(text, "a.stl", Element::line, 12, "solid is expected, not 'further'");
}

TEST(Stl, error_in_ascii_names_the_line) {
    const std::string facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n";
    const auto bad = [](const std::string& text, std::int64_t line, const char* what) {
        SCOPED_TRACE(text);
        expect_bad(text, "a.stl", Element::line, line, what);
    };
    bad("solid\n" + facet.substr(0, facet.size() - 9), 8, "endfacet is missing");
    bad("solid a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 endloop endfacet endsolid", 1,
        "no line follows this one, which holds the solid's name");
    const TriangleMesh cut = read_bytes("solid a\n" + facet + "endsolid a\nsolid b\n", "a.stl");
    EXPECT_EQ(cut.triangle_count(), 1);
    ASSERT_EQ(cut.warnings.size(), 1u);
    EXPECT_TRUE(contains(cut.warnings[0], "endsolid is missing"));
    bad("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\n", 8,
        "a facet has 4 corners instead of 3");
    bad("solid\n" + facet + "endsolid\nfacet\n", 10, "solid is expected");
    bad("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n", 6,
        "a facet has 2 corners instead of 3");
    bad("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n", 4, "'inf'");
    bad("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n", 5, "'vertex'");
    bad("solid\nsphere 1\nendsolid\n", 2, "'sphere'");
}

}  // namespace
}  // namespace crumple::io::test
