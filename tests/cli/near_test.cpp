#include <nlohmann/json.hpp>

#include "moving.h"

namespace crumple::cli::test {
namespace {

using Near = Moving;

// Row of the lowest corner of the upper triangle, which is 1 above the lower triangle. Two edges of the upper triangle
// have the squared distance 2 from two edges of the lower triangle.
constexpr const char* closest = "vf 3 0 1\n";

TEST_F(Near, pairs_go_to_standard_output) {
    EXPECT_EQ(list("near above.off --radius 1"), closest);
    EXPECT_EQ(list("near above.off --radius 1 --backend reference"), closest);
    EXPECT_EQ(list("near above.off --radius 0.999"), "");
    EXPECT_TRUE(list("near above.off --radius 1.5").starts_with(std::string(closest) + "ee 0 1 3 4 2\n"));
    EXPECT_EQ(list("near above.off --radius 1.5"), list("near above.off --radius 1.5 --backend reference"));
}

TEST_F(Near, below_excludes_pairs_at_the_radius) {
    EXPECT_EQ(list("near above.off --radius 1 --below"), "");
    EXPECT_EQ(list("near above.off --radius 1.0000000000000002 --below"), closest);
}

TEST_F(Near, ids_name_their_file_if_two_files_are_given) {
    write("lower.off", "OFF\n3 1 0\n0 0 0\n4 0 0\n0 4 0\n3 0 1 2\n");
    write("upper.off", "OFF\n6 2 0\n1 1 1\n2 1 2\n1 2 2\n1 1 1.5\n2 1 2.5\n1 2 2.5\n3 0 1 2\n3 3 4 5\n");
    EXPECT_EQ(list("near lower.off upper.off --radius 1"), "vf 1:0 0:0 1\n");
    EXPECT_EQ(list("near upper.off lower.off --radius 1"), "vf 0:0 1:0 1\n");
    const std::string edges = list("near lower.off upper.off --radius 1.45");
    EXPECT_TRUE(contains(edges, "\nee 0:0 0:1 1:0 1:1 2\n")) << edges;
    EXPECT_FALSE(contains(edges, "vf 1:0 1:1")) << "the two triangles of one file";
    EXPECT_EQ(crumple("near lower.off upper.off --radius 1 -o a.csv -o a.json -o a.npz -o a.glb").status, 0);
    EXPECT_EQ(read("a.csv"), "kind,vertex,face,a,b,c,d,squared_distance,touching\nvf,1:0,0:0,,,,,1,0\n");
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["vertex_face_bodies"], nlohmann::json::parse("[[1,0]]"));
    EXPECT_TRUE(contains(read("a.npz"), "vertex_face_bodies.npy"));
    EXPECT_TRUE(contains(read("a.glb"), "\"free\""));
}

TEST_F(Near, pairs_are_written_in_every_format) {
    const Outcome outcome = crumple("near above.off --radius 1 -o a.txt -o a.csv -o a.json -o a.npz -o a.glb");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("1 near pair (1 vertex-face, 0 edge-edge), ")) << outcome.err;
    EXPECT_EQ(read("a.txt"), closest);
    EXPECT_EQ(read("a.csv"), "kind,vertex,face,a,b,c,d,squared_distance,touching\nvf,3,0,,,,,1,0\n");
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["vertex_face_squared_distance"], nlohmann::json::parse("[1]"));
    EXPECT_TRUE(contains(read("a.npz"), "vertex_face_squared_distance.npy"));
    EXPECT_EQ(crumple("verify --radius 1 above.off a.npz").status, 0);
    EXPECT_TRUE(contains(read("a.glb"), "shade 8"));
    EXPECT_TRUE(crumple("near above.off --radius 0 -o a.txt").err.starts_with("nothing is near: 2 triangles, "));
}

TEST_F(Near, lines_and_points_of_obj_take_part) {
    // A triangle, a strand of two segments above it, and two drops.
    write("hair.obj",
          "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 1\nv 1 1 2\nv 1 2 2.5\nv 1 1 5\nv 1 1.5 5\nf 1 2 3\nl 4 5 6\np 7 8\n");
    EXPECT_EQ(list("near hair.obj --radius 1"), "vf 3 0 1\nve 3 4 5 1\nvv 6 7 0.25\n");
    const std::string more = list("near hair.obj --radius 2.5");
    EXPECT_TRUE(contains(more, "\nee 0 1 3 4 2\n")) << more;
    EXPECT_TRUE(contains(more, "\nve 3 4 5 ")) << more << "the first vertex of the strand, against its last segment";
    EXPECT_EQ(more, list("near hair.obj --radius 2.5 --backend reference"));
    write("list.txt", more);
    EXPECT_TRUE(crumple("verify --radius 2.5 hair.obj list.txt").out.starts_with("right: "));
    write("list.txt", "vv 7 6 0.25\n");
    EXPECT_TRUE(contains(crumple("verify --radius 1 hair.obj list.txt").out, "2 missed, 0 false"));
    EXPECT_TRUE(crumple("near hair.obj --radius 1 -o a.csv")
                    .err.starts_with("3 near pairs (1 vertex-face, 0 edge-edge, 1 vertex-edge, 1 vertex-vertex), "));
    EXPECT_TRUE(contains(list("near hair.obj above.off --radius 0"), "vf 0:3 1:1 0\n"));
    write("bad.obj", "v 0 0 0\nv 1 0 0\nl 1 1\n");
    expect_refused("near bad.obj --radius 1", "bad.obj, line 3: a line names a vertex twice in succession");
    EXPECT_EQ(crumple("detect bad.obj").status, 0) << "which does not read lines";
}

TEST_F(Near, check_reports_near_pairs_by_exit_status) {
    Outcome outcome = crumple("near above.off --radius 1 --check");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "something is near\n");
    outcome = crumple("near above.off --radius 0.5 --check");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "nothing is near\n");
    EXPECT_EQ(crumple("near above.off --radius 1 --check -o a.txt").status, 1);
    EXPECT_EQ(read("a.txt"), closest);
}

TEST_F(Near, options_for_groups_statistics_and_progress_are_obeyed) {
    EXPECT_EQ(list("near above.off --radius 1 --groups components --filter between"), closest);
    EXPECT_EQ(list("near above.off --radius 1 --groups components --filter within"), "");
    EXPECT_TRUE(contains(crumple("near above.off --radius 1 --stats").err, "1 vertex-face, 0 edge-edge"));
    EXPECT_TRUE(contains(crumple("near above.off --radius 1 --progress").err, " s  search\n"));
}

TEST_F(Near, radii_can_be_given_per_vertex_in_a_file) {
    write("radii.txt", "# of the face, then of the corner above it\n0.75\n0\n0\n\n0.25\n0\n0\n");
    EXPECT_EQ(list("near above.off --radii radii.txt"), closest);
    EXPECT_EQ(list("near above.off --radii radii.txt --backend reference"), closest);
    EXPECT_EQ(list("near above.off --radii radii.txt --below"), "");
    EXPECT_EQ(crumple("near above.off --radii radii.txt --check").out, "something is near\n");
    expect_refused("near above.off --radii radii.txt --radius 1", "--radi");
    expect_refused("near above.off below.off --radii radii.txt", "--radii does not support two meshes");
    expect_refused("near above.off --radii radii.txt -o radii.txt", "would overwrite the input radii.txt");
    write("few.txt", "1\n2\n");
    expect_refused("near above.off --radii few.txt", "few.txt: 2 radii for 6 vertices");
    for (const char* const bad : {"-1", "inf", "nan", "x"}) {
        write("bad.txt", "1\n" + std::string(bad) + "\n");
        expect_refused("near above.off --radii bad.txt", "is not a radius of 0 or more");
        expect_refused("near above.off --radii bad.txt", "line 2");
    }
    write("two.txt", "1 2\n");
    expect_refused("near above.off --radii two.txt", "each line must have only one radius");
    expect_refused("near above.off --radii missing.txt", "missing.txt");
}

TEST_F(Near, pairs_close_in_the_rest_shape_are_excluded) {
    EXPECT_EQ(list("near above.off --radius 1 --rest above.off"), closest) << "it does not touch there";
    EXPECT_EQ(list("near above.off --radius 1 --rest above.off --rest-radius 1"), "");
    EXPECT_EQ(list("near above.off --radius 1 --rest above.off --rest-radius 0.99"), closest);
    EXPECT_EQ(crumple("near above.off --radius 1 --rest above.off --rest-radius 1 --check").out, "nothing is near\n");
    expect_refused("near above.off --radius 1 --rest-radius 1", "--rest-radius needs --rest");
    expect_refused("near above.off below.off --radius 1 --rest above.off", "--rest does not support two meshes");
    write("other.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n2 1 2\n1 2 2\n3 0 1 2\n3 3 5 4\n");
    expect_refused("near above.off --radius 1 --rest other.off", "triangle 1 has other vertices");
}

TEST_F(Near, pairs_of_features_within_the_given_rings_are_excluded) {
    write("square.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 2 1 3\n");
    EXPECT_EQ(list("near square.off --radius 1"), "vf 0 1 0.5\nvf 3 0 0.5\nee 0 1 2 3 1\nee 0 2 1 3 1\n");
    EXPECT_EQ(list("near square.off --radius 1 --rings 0"), list("near square.off --radius 1"));
    EXPECT_EQ(list("near square.off --radius 1 --rings 1"), "");
    EXPECT_EQ(list("near above.off --radius 1 --rings 5"), closest) << "no edge leads there";
    // Edge 4-5 is 1 above edge 0-1. Every path between their triangles goes through edge 1-3 or 2-3.
    write("bent.off", "OFF\n6 3 0\n0 0 0\n0 1 0\n5 0 0\n5 1 1\n0 0 1\n0 1 1\n3 0 1 2\n3 2 1 3\n3 3 4 5\n");
    EXPECT_EQ(list("near bent.off --radius 1 --rings 1"),
              "vf 0 2 1\nvf 4 0 1\nvf 5 0 1\nee 0 1 4 5 1\nee 0 2 4 5 1\nee 1 2 4 5 1\n");
    EXPECT_EQ(list("near bent.off --radius 1 --rings 2"), "");
    expect_refused("near above.off --radius 1 --rings -1", "-1 is not an integer from 0 to 2147483647");
}

TEST_F(Near, wrong_arguments_are_refused) {
    expect_refused("near above.off", "near: --radius or --radii is required");
    expect_refused("near above.off --radius", "near: --radius: 1 required R missing");
    for (const char* const bad : {"-1", "inf", "nan", "1m"})
        expect_refused(std::string("near above.off --radius ") + bad,
                       std::string(bad) + " is not a distance of 0 or more");
    expect_refused("near above.off above.off above.off --radius 1", "near:");
    expect_refused("near above.off --radius 1 -o a.html",
                   "near pairs are written as .txt, .csv, .json or .npz, coloured as .glb");
    expect_refused("near above.off --radius 1 --groups bodies --filter between",
                   "--groups bodies is for crumple detect");
}

}  // namespace
}  // namespace crumple::cli::test
