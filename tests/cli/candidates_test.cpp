#include <nlohmann/json.hpp>

#include "moving.h"

namespace crumple::cli::test {
namespace {

using Candidates = Moving;

const std::string step = "impacts above.off below.off --candidates", static_query = "impacts above.off --candidates";

// Candidates of the corner that falls through the lower triangle, and of the two edges that end at it.
constexpr const char* step_candidates = "vf 3 0\nee 1 2 3 4\nee 1 2 3 5\n";

TEST_F(Candidates, candidates_go_to_standard_output) {
    EXPECT_EQ(list(step), step_candidates);
    EXPECT_EQ(list(step + " --backend reference"), step_candidates);
    EXPECT_EQ(list(step + " --threads 1"), step_candidates);
    EXPECT_EQ(shell("cat above.off | $crumple impacts - below.off --candidates").out, step_candidates);
}

TEST_F(Candidates, one_file_gives_static_candidates) {
    EXPECT_EQ(list(static_query), "");
    EXPECT_EQ(list(static_query + " --kinds vertex_face --inflation 0.5"), "vf 0 1\nvf 3 0\n");
    EXPECT_EQ(list(static_query + " --kinds vertex_face --inflation 0.499"), "");
    EXPECT_EQ(list("impacts above.off above.off --candidates --kinds vertex_face --inflation 0.5"),
              list(static_query + " --kinds vertex_face --inflation 0.5"));
}

TEST_F(Candidates, each_kind_of_candidate_has_its_tag) {
    const std::string all = static_query + " --inflation 0.5 --kinds ";
    EXPECT_EQ(list(all + "edge_face,face_face"), "ef 0 1 1\nef 0 2 1\nef 1 2 1\nef 3 4 0\nef 3 5 0\nff 0 1\n");
    EXPECT_EQ(list(all + "face_face --kinds edge_face"), list(all + "edge_face,face_face"));
    EXPECT_EQ(list(all + "vertex_vertex"), "vv 0 3\nvv 3 4\nvv 3 5\nvv 4 5\n");
    EXPECT_TRUE(contains(list(all + "vertex_edge"), "ve 3 1 2\n"));
    const std::string by_default = list(static_query + " --inflation 0.5");
    EXPECT_TRUE(contains(by_default, "vf 3 0\n") && contains(by_default, "ee 1 2 3 4\n")) << by_default;
    EXPECT_EQ(list(all + "vertex_face,edge_edge"), by_default);
}

TEST_F(Candidates, candidates_are_written_in_every_format) {
    const Outcome outcome = crumple(step + " --kinds vertex_face,face_face -o a.txt -o a.csv -o a.json -o a.npz");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("2 candidates (1 vertex-face, 1 face-face), ")) << outcome.err;
    EXPECT_EQ(read("a.txt"), "vf 3 0\nff 0 1\n");
    EXPECT_EQ(read("a.csv"), "kind,vertex,face,a,b,c,d\nvf,3,0,,,,\nff,,0,1,,,\n");
    const auto json = nlohmann::json::parse(read("a.json"));
    EXPECT_EQ(json["vertex_faces"], nlohmann::json::parse("[[3,0]]"));
    EXPECT_EQ(json["face_faces"], nlohmann::json::parse("[[0,1]]"));
    EXPECT_EQ(json["statistics"]["pairs"], 2);
    EXPECT_FALSE(json.contains("edge_edges")) << "which was not requested";
    EXPECT_TRUE(contains(read("a.npz"), "face_faces.npy"));
    EXPECT_FALSE(contains(read("a.npz"), "edge_edges.npy"));
    EXPECT_EQ(crumple("verify --candidates above.off below.off a.npz --kinds vertex_face,face_face").status, 0);
    EXPECT_EQ(crumple(step + " --kinds vertex_face,face_face -o - --format csv").out, read("a.csv"));
}

TEST_F(Candidates, summary_of_empty_list_counts_triangles) {
    const Outcome outcome = crumple(static_query + " -o a.txt");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(outcome.err.starts_with("no candidates: 2 triangles, ")) << outcome.err;
    EXPECT_EQ(read("a.txt"), "");
}

TEST_F(Candidates, options_for_groups_welding_and_statistics_are_obeyed) {
    const std::string groups = step + " --groups components --filter ";
    EXPECT_EQ(list(groups + "between"), step_candidates);
    EXPECT_EQ(list(groups + "within"), "");
    // Two triangles that touch at vertices 0 and 3. Welding makes these one vertex of both triangles.
    write("corner.off", "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n0 0 0\n-1 0 1\n0 -1 1\n3 0 1 2\n3 3 4 5\n");
    EXPECT_EQ(list("impacts corner.off --candidates --kinds vertex_face"), "vf 0 1\nvf 3 0\n");
    EXPECT_EQ(list("impacts corner.off --candidates --kinds vertex_face --weld"), "");
    EXPECT_EQ(list("impacts corner.off --candidates --kinds vertex_face --weld --with-neighbours"),
              "vf 0 0\nvf 0 1\nvf 1 0\nvf 2 0\nvf 3 0\nvf 3 1\nvf 4 1\nvf 5 1\n");
    const Outcome outcome = crumple(step + " --stats");
    EXPECT_EQ(outcome.out, step_candidates);
    EXPECT_TRUE(contains(outcome.err, "1 vertex-face, 2 edge-edge")) << outcome.err;
}

TEST_F(Candidates, lines_and_points_of_obj_take_part) {
    write("hair.obj", "v 0 0 0\nv 1 0 0\nv 0.5 1 0\nv 0.5 1.5 0\nl 1 2\np 3 4\n");
    EXPECT_EQ(list("impacts hair.obj --candidates --kinds vertex_edge,vertex_vertex --inflation 0.5"),
              "ve 2 0 1\nvv 0 1\nvv 0 2\nvv 1 2\nvv 2 3\n");
}

TEST_F(Candidates, wrong_options_are_refused) {
    for (const char* const option : {"--min-distance 0", "--min-distance-share 0.1", "--first", "--check"}) {
        const std::string name = std::string(option).substr(0, std::string(option).find(' '));
        expect_refused(step + ' ' + option, name + " does not go with --candidates");
    }
    for (const char* const option : {"--inflation 0", "--kinds vertex_face", "--with-neighbours"}) {
        const std::string name = std::string(option).substr(0, std::string(option).find(' '));
        expect_refused(std::string("impacts above.off below.off ") + option, name + " needs --candidates");
    }
    expect_refused(step + " -o a.glb", "-o a.glb: candidates are written as .txt, .csv, .json or .npz");
    expect_refused(step + " -o - --format glb", "candidates are written as .txt, .csv, .json or .npz");
    expect_refused(step + " -o a.ply", "candidates are written as");
    expect_refused(step + " -o none/a.csv", "cannot write none/a.csv");
    expect_refused(step + " -o -", "-o - needs --format");
    expect_refused(step + " --kinds face_vertex", "--kinds: face_vertex is not one of vertex_face|edge_edge|");
    for (const char* const bad : {"-1", "nan", "inf", "x"})
        expect_refused(step + " --inflation " + bad,
                       "--inflation: " + std::string(bad) + " is not a distance of 0 or more");
    expect_refused(step + " --triangle-pairs", "--triangle-pairs does not go with --candidates");
    expect_refused("impacts - - --candidates", "standard input, -, can be read only once");
    expect_refused("impacts missing.off --candidates", "missing.off");
    write("a.csv", above_off);
    expect_refused("impacts a.csv --candidates -o a.csv", "would overwrite the input a.csv");
    expect_refused(step + " --backend cuda", "cuda");
}

}  // namespace
}  // namespace crumple::cli::test
