#include <nlohmann/json.hpp>

#include "moving.h"

namespace crumple::cli::test {
namespace {

using Impacts = Moving;

constexpr const char* impact = "vf 3 0 0.5 0\n";

TEST_F(Impacts, impacts_go_to_standard_output) {
    EXPECT_EQ(list("impacts above.off below.off"), impact);
    EXPECT_EQ(list("impacts above.off below.off --backend reference"), impact);
    EXPECT_EQ(list("impacts above.off below.off --threads 1"), impact);
    EXPECT_EQ(list("impacts above.off above.off"), "");
    EXPECT_EQ(shell("cat above.off | $crumple impacts - below.off").out, impact);
}

TEST_F(Impacts, contact_at_the_start_has_time_zero) {
    write("touching.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 0\n2 1 2\n1 2 2\n3 0 1 2\n3 3 4 5\n");
    EXPECT_EQ(list("impacts touching.off above.off"), "vf 3 0 0 1\n");
}

TEST_F(Impacts, impacts_are_written_in_every_format) {
    const Outcome outcome = crumple("impacts above.off below.off -o a.txt -o a.csv -o a.json -o a.npz -o a.glb");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("1 impact (1 vertex-face, 0 edge-edge), the first at 0.5, ")) << outcome.err;
    EXPECT_EQ(read("a.txt"), impact);
    EXPECT_EQ(read("a.csv"), "kind,vertex,face,a,b,c,d,toi,start\nvf,3,0,,,,,0.5,0\n");
    const auto json = nlohmann::json::parse(read("a.json"));
    EXPECT_EQ(json["vertex_faces"], nlohmann::json::parse("[[3,0]]"));
    EXPECT_EQ(json["edges"].size(), 6u);
    EXPECT_EQ(json["earliest"]["toi"], 0.5);
    EXPECT_TRUE(contains(read("a.npz"), "vertex_face_toi.npy"));
    EXPECT_EQ(crumple("verify --impacts above.off below.off a.npz").status, 0);
    EXPECT_TRUE(contains(read("a.glb"), "shade 5"));
    EXPECT_EQ(crumple("impacts above.off below.off -o - --format csv").out, read("a.csv"));
    EXPECT_EQ(crumple("impacts above.off below.off -o - --format glb").out, read("a.glb"));
}

TEST_F(Impacts, first_lists_only_the_earliest_impact) {
    // Triangles 2 and 3 do what 0 and 1 do, later.
    const std::string more = "9 9 0\n13 9 0\n9 13 0\n10 10 3\n11 10 4\n10 11 4\n3 0 1 2\n3 3 4 5\n3 6 7 8\n3 9 10 11\n";
    write("start.off", "OFF\n12 4 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n2 1 2\n1 2 2\n" + more);
    std::string below = more;
    below.replace(below.find("10 10 3"), 7, "10 10 -1");
    write("end.off", "OFF\n12 4 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n2 1 0.5\n1 2 0.5\n" + below);
    EXPECT_TRUE(list("impacts start.off end.off").starts_with("vf 3 0 0.5 0\nvf 9 2 0.75 0\n"));
    EXPECT_EQ(list("impacts start.off end.off --first"), impact);
    EXPECT_EQ(list("impacts start.off start.off --first"), "");
    // From a greater height, triangle 1 touches triangle 0 later than triangle 3 touches triangle 2.
    write("high.off", "OFF\n12 4 0\n0 0 0\n4 0 0\n0 4 0\n1 1 7\n2 1 8\n1 2 8\n" + more);
    EXPECT_TRUE(list("impacts high.off end.off").starts_with("vf 3 0 0.875 0\n"));
    EXPECT_EQ(list("impacts high.off end.off --first"), "vf 9 2 0.75 0\n");
    const Outcome outcome = crumple("impacts start.off end.off --first -o a.json");
    EXPECT_TRUE(outcome.err.starts_with("the first impact is at 0.5, ")) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["vertex_faces"].size(), 1u);
}

TEST_F(Impacts, check_reports_impacts_by_exit_status) {
    Outcome outcome = crumple("impacts above.off below.off --check");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "something touches\n");
    outcome = crumple("impacts above.off above.off --check");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "nothing touches\n");
    outcome = crumple("impacts above.off below.off --check -o a.txt");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(read("a.txt"), impact);
    EXPECT_EQ(crumple("impacts above.off below.off --check --first -o a.txt").status, 1);
    EXPECT_EQ(crumple("impacts above.off above.off --check -o a.txt").status, 0);
    EXPECT_EQ(read("a.txt"), "");
}

TEST_F(Impacts, summary_of_empty_list_counts_triangles) {
    const Outcome outcome = crumple("impacts above.off above.off -o a.txt");
    EXPECT_TRUE(outcome.err.starts_with("nothing touches: 2 triangles, ")) << outcome.err;
}

TEST_F(Impacts, statistics_go_to_standard_error) {
    EXPECT_TRUE(contains(crumple("impacts above.off below.off --progress").err, " s  search\n"));
    const Outcome outcome = crumple("impacts above.off below.off --stats");
    EXPECT_EQ(outcome.out, impact);
    EXPECT_TRUE(contains(outcome.err, "1 vertex-face, 0 edge-edge")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "wall clock")) << outcome.err;
}

TEST_F(Impacts, pairs_within_min_distance_count_as_touching) {
    EXPECT_EQ(list("impacts above.off below.off --min-distance 0.25"), "vf 3 0 0.375 0\n");
    const std::string halved = list("impacts above.off below.off --min-distance-share 0.5");
    EXPECT_TRUE(halved.starts_with("vf 3 0 0.25 0\n")) << halved;
    EXPECT_EQ(list("impacts above.off below.off --min-distance 0.25 --min-distance-share 0.5"), halved);
    EXPECT_TRUE(list("impacts above.off below.off --min-distance 0.75 --min-distance-share 0.5")
                    .starts_with("vf 3 0 0.125 0\n"));
    EXPECT_EQ(list("impacts above.off above.off --min-distance 1"), "vf 3 0 0 1\n");
    EXPECT_EQ(list("impacts above.off above.off --min-distance 1 --approaching-only"), "");
    EXPECT_TRUE(list("impacts above.off below.off --min-distance 1 --approaching-only").starts_with("vf 3 0 0 1\n"));
    EXPECT_EQ(list("impacts above.off below.off --approaching-only"), list("impacts above.off below.off"));
    for (const char* const bad : {"-1", "nan", "inf", "1e999", "x", "''", "1x"})
        expect_refused(std::string("impacts above.off below.off --min-distance ") + bad,
                       "is not a distance of 0 or more");
    for (const char* const bad : {"1", "-0.1", "nan"})
        expect_refused(std::string("impacts above.off below.off --min-distance-share ") + bad,
                       "is not a share of 0 or more");
}

TEST_F(Impacts, groups_filter_impacts) {
    write("groups.txt", "0\n1\n");
    EXPECT_EQ(list("impacts above.off below.off --groups groups.txt --filter between"), impact);
    EXPECT_EQ(list("impacts above.off below.off --groups groups.txt --filter within"), "");
    EXPECT_EQ(list("impacts above.off below.off --groups components --filter within"), "");
}

TEST_F(Impacts, weld_merges_only_vertices_equal_at_both_times) {
    // Vertex 3 coincides with vertex 0 in start.off, but not in end.off.
    write("start.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n0 0 0\n-1 0 1\n0 -1 1\n3 0 1 2\n3 3 4 5\n");
    write("end.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n0 0 1\n-1 0 2\n0 -1 2\n3 0 1 2\n3 3 4 5\n");
    const std::string apart = list("impacts start.off end.off");
    EXPECT_TRUE(apart.starts_with("vf 0 1 0 1\nvf 3 0 0 1\n")) << apart;
    EXPECT_EQ(list("impacts start.off end.off --weld"), apart);
    const std::string back = list("impacts end.off start.off");
    EXPECT_TRUE(back.starts_with("vf 0 1 1 0\nvf 3 0 1 0\n")) << back;
    EXPECT_EQ(list("impacts end.off start.off --weld"), back);
    EXPECT_NE(list("impacts start.off start.off"), "");
    EXPECT_EQ(list("impacts start.off start.off --weld"), "") << "now the corner is one vertex";
}

TEST_F(Impacts, stl_files_welded_differently_are_refused_without_a_weld_option) {
    const std::string stl =
        "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex -1 0 0\nvertex 0 -1 0\nendloop\nendfacet\nendsolid\n";
    write("start.stl", stl);
    std::string parted = stl;
    parted.replace(parted.find("0 0 0\nvertex -1"), 5, "0 0 1");
    write("end.stl", parted);
    EXPECT_EQ(list("impacts start.stl start.stl"), "");
    EXPECT_EQ(list("impacts start.stl start.stl --weld"), "");
    expect_refused("impacts start.stl end.stl", "but have 5 and 6 vertices (each STL file was welded separately");
    EXPECT_TRUE(list("impacts start.stl end.stl --weld").starts_with("vf 0 1 0 1\nvf 3 0 0 1\n"));
    EXPECT_EQ(list("impacts start.stl end.stl --weld"), list("impacts start.stl end.stl --no-weld"));
}

TEST_F(Impacts, lines_and_points_of_obj_take_part) {
    const std::string elements = "l 1 2\np 3\n";
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0.5 1 0\n" + elements);
    write("b.obj", "v 0 0 0\nv 1 0 0\nv 0.5 -1 0\n" + elements);
    EXPECT_EQ(list("impacts a.obj b.obj"), "ve 2 0 1 0.5 0\n");
    EXPECT_EQ(list("impacts a.obj b.obj --first"), "ve 2 0 1 0.5 0\n");
    write("list.txt", "ve 2 1 0 0.5\n");
    EXPECT_TRUE(crumple("verify --impacts a.obj b.obj list.txt").out.starts_with("right: 1 impacts"));
    write("b.obj", "v 0 0 0\nv 1 0 0\nv 0.5 -1 0\nl 1 2\n");
    expect_refused("impacts a.obj b.obj", "lines or points have other vertices");
}

TEST_F(Impacts, different_meshes_at_the_two_times_are_refused) {
    write("more.off", "OFF\n7 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n2 1 2\n1 2 2\n7 7 7\n3 0 1 2\n3 3 4 5\n");
    write("less.off", "OFF\n6 1 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n2 1 2\n1 2 2\n3 0 1 2\n");
    write("other.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n2 1 2\n1 2 2\n3 0 1 2\n3 3 5 4\n");
    const auto named = [&](const std::string& end) {
        return "above.off and " + end + " must be one mesh at two times";
    };
    expect_refused("impacts above.off more.off", named("more.off") + ", but have 6 and 7 vertices");
    expect_refused("impacts above.off less.off", named("less.off") + ", but have 2 and 1 triangles");
    expect_refused("impacts above.off other.off", named("other.off") + ", but triangle 1 has other vertices");
}

TEST_F(Impacts, end_polygons_are_triangulated_like_those_of_the_start) {
    // A square whose first corner, vertex 0, moves inwards. So it is concave at the end, and would be cut along the
    // diagonal from 0 to 2 if it were cut anew.
    const std::string faces = "4 1 2 3 0\n3 4 5 6\n", other_vertices = "4 0 0\n4 4 0\n0 4 0\n1 1 ";
    const std::string start = "OFF\n7 2 0\n0 0 0\n" + other_vertices + "5\n2 1 6\n1 2 6\n",
                      end = "OFF\n7 2 0\n3 3 0\n" + other_vertices + "-1\n2 1 6\n1 2 6\n";
    write("start.off", start + faces);
    write("end.off", end + faces);
    ASSERT_NE(crumple("detect start.off -o a.ply").status, 2);
    const std::string result = list("impacts start.off end.off");
    EXPECT_EQ(result, list("impacts start.off end.off --triangulation fan"));
}

TEST_F(Impacts, wrong_arguments_are_refused) {
    expect_refused("impacts above.off", "impacts: END is required; see crumple impacts --help");
    expect_refused("impacts - -", "standard input, -, can be read only once");
    expect_refused("impacts above.off below.off -o a.ply",
                   "impacts are written as .txt, .csv, .json or .npz, coloured as .glb");
    expect_refused("impacts above.off below.off -o above.off", "impacts are written as");
    expect_refused("impacts above.off below.off -o -", "-o - needs --format");
    expect_refused("impacts above.off below.off --neighbours skip", "not expected");
    expect_refused("impacts above.off below.off --min-distence 1", "did you mean --min-distance?");
    expect_refused("impacts above.off missing.off", "missing.off");
    expect_refused("impact above.off below.off", "impact; did you mean impacts?");
    write("a.csv", above_off);
    expect_refused("impacts a.csv below.off -o a.csv", "would overwrite the input a.csv");
    EXPECT_EQ(read("a.csv"), above_off);
}

}  // namespace
}  // namespace crumple::cli::test
