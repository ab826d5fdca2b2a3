#include "samples.h"

namespace crumple::io::test {
namespace {

const std::string four = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

std::vector<std::int32_t> triangles(const std::string& text) { return read_bytes(text, "a.obj").triangles; }

using Indices = std::vector<std::int32_t>;

TEST(Obj, CornersMayNameTextureCoordinatesAndNormals) {
    EXPECT_EQ(triangles(four + "f 1/1 2/2 3/3\nf 1//1 2//2 3//3\nf 1/1/1 3/2/2 4/3/3\nf 1/-1/-1 2/ 3\n"),
              (Indices{0, 1, 2, 0, 1, 2, 0, 2, 3, 0, 1, 2}));
}

TEST(Obj, NegativeIndicesCountBackFromTheLastVertexSoFar) {
    EXPECT_EQ(triangles("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -1 -2\n"), (Indices{0, 1, 2, 0, 3, 2}));
}

TEST(Obj, AFaceMayNameAVertexThatComesLater) {
    EXPECT_EQ(triangles("f 1 2 3\n" + four), (Indices{0, 1, 2}));
    expect_bad("\nf 1 2 5\n" + four, "a.obj", Element::line, 2, "vertex 5 of 4");
}

TEST(Obj, PolygonsAreFannedFromTheirFirstCorner) {
    EXPECT_EQ(triangles(four + "f 2 3 4 1\n"), (Indices{1, 2, 3, 1, 3, 0}));
}

TEST(Obj, ObjectsAndGroupsAreNotGroups) {
    EXPECT_TRUE(read_bytes("o a\n" + four + "g b\nf 1 2 3\n", "a.obj").groups.empty());
}

TEST(Obj, ABackslashContinuesALine) {
    EXPECT_EQ(triangles(four + "f 1 \\\n2 \\\r\n3\nf 1\\\n 2 3\n"), (Indices{0, 1, 2, 0, 1, 2}));
    EXPECT_EQ(triangles("v 0 \\\n 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\\\nf 1 2 3\nf 1 2 3\n").size(), 3u)
        << "a skipped statement takes its continuation with it";
}

TEST(Obj, ACommentEndsWithItsLine) {
    EXPECT_EQ(triangles("# C:\\\n" + four + "f 1 2 4 # 3\n#f 1 2 3\n   # f 1 2 3\n"), (Indices{0, 1, 3}));
}

TEST(Obj, FurtherComponentsOfAVertexAreSkipped) {
    const auto mesh = read_bytes("v 1 2 3 4\nv 1 2 3 .1 .2 .3\nv\t1  2 3\t\nf 1 2 3", "a.obj");
    EXPECT_EQ(coordinates(mesh), (std::vector<double>{1, 2, 3, 1, 2, 3, 1, 2, 3}));
}

TEST(Obj, MistakesAreErrorsThatNameTheLine) {
    const auto bad = [](const std::string& text, std::int64_t line, const char* what) {
        SCOPED_TRACE(text);
        expect_bad(four + text, "a.obj", Element::line, line, what);
    };
    bad("f 1 2\n", 5, "2 corners");
    bad("f\n", 5, "0 corners");
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
    bad("w 1 2 3\n", 5, "unknown statement 'w'");
    bad("surf 0 1 0 1 1 2 3 4\n", 5, "unknown statement 'surf'");
    bad("\x1b[2J\n", 5, "'?[2J'");
}

TEST(Obj, PointsAndLinesAreNoTriangles) {
    EXPECT_EQ(triangles(four + "p 1\nl 1 2\ns off\nusemtl x\nvt 0 0\nvp 0 0\nf 1 2 3\n"), (Indices{0, 1, 2}));
}

TEST(Obj, WithoutFacesThereAreNoTriangles) {
    EXPECT_EQ(read_bytes(four, "a.obj").vertex_count(), 4);
    EXPECT_EQ(read_bytes(four, "a.obj").triangle_count(), 0);
}

}  // namespace
}  // namespace crumple::io::test
