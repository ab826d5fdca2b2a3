#include "run.h"

namespace crumple::cli::test {
namespace {

using Info = Cli;

TEST_F(Info, TellsWhatAMeshHolds) {
    write("five.off", five_off);
    const Outcome outcome = crumple("info five.off");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out,
              "vertices              14 (1 unused)\n"
              "triangles             5\n"
              "precision             float64\n"
              "box                   -1 -1 -1 to 14 7 7\n"
              "degenerate triangles  0\n"
              "duplicated triangles  0\n"
              "open edges            13\n"
              "non-manifold edges    0\n"
              "connected components  4\n");
}

TEST_F(Info, GoesByPositionsIfWelded) {
    write("five.off", five_off);
    const std::string out = crumple("info five.off --weld --precision float32").out;
    EXPECT_TRUE(contains(out, "vertices              13 (1 unused)\n")) << out;
    EXPECT_TRUE(contains(out, "precision             float32\n")) << out;
    EXPECT_TRUE(contains(out, "connected components  3\n")) << out;
}

TEST_F(Info, NamesOddTriangles) {
    // 0.1, 0.2, 0.3 times (1, 1, 1) are on one line as float64 numbers, 0.1, 0.2, 0.3 along x and y alone are not: 0.3
    // is not three times 0.1 there.
    write("odd.off",
          "OFF\n9 8 0\n0 0 0\n1 0 0\n0 1 0\n0 1 0\n1 0 0\n0.1 0.1 0.1\n0.2 0.2 0.2\n0.3 0.3 0.3\n0.3 0.6 0\n"
          "3 0 1 2\n"    // sound
          "3 3 0 4\n"    // the same place, other vertices, another order
          "3 2 1 0\n"    // the same vertices
          "3 0 0 1\n"    // a segment
          "3 5 6 7\n"    // a segment
          "3 2 2 2\n"    // a point
          "3 0 1 8\n"    // a third triangle at edge 0-1, counting the next one as well
          "3 1 0 8\n");  // the same vertices
    const std::string out = crumple("info odd.off").out;
    EXPECT_TRUE(contains(out, "degenerate triangles  3 (3, 4, 5)\n")) << out;
    EXPECT_TRUE(contains(out, "duplicated triangles  3 (1, 2, 7)\n")) << out;
    EXPECT_TRUE(contains(out, "non-manifold edges    1\n")) << out;
}

TEST_F(Info, DecidesDegeneracyExactly) {
    // In float64, 0.1 + 0.2 > 0.3 and the points (i, 0.i) lie on no line; scaled to integers they do.
    write("almost.off", "OFF\n3 1 0\n1 0.1 0\n2 0.2 0\n3 0.3 0\n3 0 1 2\n");
    EXPECT_TRUE(contains(crumple("info almost.off").out, "degenerate triangles  0\n"));
    write("exactly.off", "OFF\n3 1 0\n1 1e-300 0\n2 2e-300 0\n4 4e-300 0\n3 0 1 2\n");
    EXPECT_TRUE(contains(crumple("info exactly.off").out, "degenerate triangles  1 (0)\n"));
}

TEST_F(Info, ShowsTheFirstFewOnly) {
    std::string off = "OFF\n2 1234 0\n0 0 0\n1 0 0\n";
    for (int i = 0; i < 1234; ++i) off += "3 0 1 1\n";
    write("many.off", off);
    EXPECT_TRUE(contains(crumple("info many.off").out, "degenerate triangles  1,234 (0, 1, 2, 3, 4, ...)\n"));
}

TEST_F(Info, OfNothingIsNothing) {
    write("empty.off", "OFF\n0 0 0\n");
    const Outcome outcome = crumple("info empty.off");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(contains(outcome.out, "triangles             0\n")) << outcome.out << outcome.err;
}

TEST_F(Info, ListsDevicesWithoutAFile) {
    const Outcome outcome = crumple("info --devices");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(outcome.out.starts_with("0  ") || outcome.out.starts_with("none: the cuda backend ")) << outcome.out;
}

}  // namespace
}  // namespace crumple::cli::test
