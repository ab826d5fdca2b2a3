#include <nlohmann/json.hpp>

#include "moving.h"

namespace crumple::cli::test {
namespace {

/// Step in which a blade slides along in the plate that it pierces: the triangles intersect, but no features touch.
class TrianglePairs : public Moving {
   protected:
    TrianglePairs() {
        const std::string plate = "-9 -9 0\n9 -9 0\n0 9 0\n", faces = "3 0 1 2\n3 3 4 5\n";
        write("start.off", "OFF\n6 2 0\n" + plate + "0 0 -1\n0.5 0 1\n-0.5 0.2 1\n" + faces);
        write("end.off", "OFF\n6 2 0\n" + plate + "1 0 -1\n1.5 0 1\n0.5 0.2 1\n" + faces);
    }
};

const std::string falling = "impacts above.off below.off --triangle-pairs", stuck = "impacts start.off end.off";

TEST_F(TrianglePairs, triangle_pairs_include_intersections_at_the_start) {
    EXPECT_EQ(list(falling), "ff 0 1 0.5 0\n");
    EXPECT_EQ(list(falling + " --backend reference"), "ff 0 1 0.5 0\n");
    EXPECT_EQ(list(stuck), "");
    EXPECT_EQ(list(stuck + " --triangle-pairs"), "ff 0 1 0 1\n");
}

TEST_F(TrianglePairs, lists_in_every_format_can_be_verified) {
    const Outcome outcome = crumple(stuck + " --triangle-pairs -o a.txt -o a.csv -o a.json -o a.npz -o a.glb");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(outcome.err.starts_with("1 pair of triangles, 1 from the start, ")) << outcome.err;
    EXPECT_EQ(read("a.csv"), "kind,vertex,face,a,b,c,d,toi,start\nff,,0,1,,,,0,1\n");
    const auto json = nlohmann::json::parse(read("a.json"));
    EXPECT_EQ(json["face_faces"], nlohmann::json::parse("[[0,1]]"));
    EXPECT_EQ(json["face_face_start"], nlohmann::json::parse("[1]"));
    EXPECT_FALSE(json.contains("vertex_faces"));
    for (const char* const file : {"a.txt", "a.csv", "a.json", "a.npz"})
        EXPECT_EQ(crumple("verify --impacts start.off end.off " + std::string(file)).out,
                  "right: 1 pairs of triangles, 0 missed, 0 false, 0 late, 0 early, 0 repeated\n");
    write("wrong.txt", "ff 1 0 0.25 0\n");
    const Outcome wrong = crumple("verify --impacts start.off end.off wrong.txt");
    EXPECT_EQ(wrong.status, 1);
    EXPECT_TRUE(contains(wrong.out, "late ff 0 1 0.25, it is 0")) << wrong.out;
}

TEST_F(TrianglePairs, list_with_pairs_and_impacts_can_be_verified) {
    write("both.txt", list("impacts above.off below.off") + list(falling));
    EXPECT_EQ(crumple("verify --impacts above.off below.off both.txt").status, 0);
    write("less.txt", list("impacts above.off below.off") + "ff 0 1 0.25 0\n");
    EXPECT_EQ(crumple("verify --impacts above.off below.off less.txt").status, 1);
}

TEST_F(TrianglePairs, triangle_pairs_decide_the_exit_status) {
    EXPECT_EQ(crumple(stuck + " --check").status, 0);
    EXPECT_EQ(crumple(stuck + " --triangle-pairs --check").status, 1);
    EXPECT_EQ(crumple(stuck + " --triangle-pairs --check -o a.txt").status, 1);
    EXPECT_TRUE(contains(crumple(falling + " --stats -o a.txt").err, "1 pair of triangles, 0 from the start"));
    EXPECT_EQ(list("impacts above.off below.off --triangle-pairs --min-distance 0.25"), "ff 0 1 0.375 0\n");
    EXPECT_TRUE(contains(crumple(falling + " --first").err, "--first does not go with --triangle-pairs"));
}

}  // namespace
}  // namespace crumple::cli::test
