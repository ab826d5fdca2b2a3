#include "moving.h"

namespace crumple::cli::test {
namespace {

class VerifyFeatures : public Moving {
   protected:
    Outcome impacts(const std::string& rows, const std::string& options = "") const {
        write("list.txt", rows);
        return crumple("verify --impacts above.off below.off list.txt " + options);
    }
    Outcome near(const std::string& rows, const std::string& options = "") const {
        write("list.txt", rows);
        return crumple("verify --radius 1 above.off list.txt " + options);
    }
};

TEST_F(VerifyFeatures, lists_in_every_format_can_be_verified) {
    write("upper.off", "OFF\n3 1 0\n1 1 1\n2 1 2\n1 2 2\n3 0 1 2\n");
    for (const std::string name : {"a.txt", "a.csv", "a.json", "a.npz"}) {
        ASSERT_EQ(crumple("impacts above.off below.off -o " + name).status, 0);
        EXPECT_EQ(crumple("verify --impacts above.off below.off " + name).out,
                  "right: 1 impacts, 0 missed, 0 false, 0 late, 0 early, 0 repeated\n");
        ASSERT_EQ(crumple("near above.off --radius 1.5 -o " + name).status, 0);
        EXPECT_EQ(crumple("verify --radius 1.5 above.off " + name).status, 0) << name;
        ASSERT_EQ(crumple("near above.off upper.off --radius 1.5 -o " + name).status, 0);
        EXPECT_EQ(crumple("verify --radius 1.5 above.off upper.off " + name).status, 0) << name;
        EXPECT_EQ(crumple("verify --radius 1.5 upper.off above.off " + name).status, 1) << name;
    }
    EXPECT_EQ(shell("$crumple impacts above.off below.off -o - --format json | $crumple verify --impacts above.off "
                    "below.off - --format json")
                  .status,
              0);
}

TEST_F(VerifyFeatures, mistakes_are_listed_by_kind) {
    EXPECT_EQ(impacts("vf 3 0 0.5 0\n").status, 0);
    EXPECT_EQ(impacts("# none\n").out,
              "wrong: 1 impacts, 1 missed, 0 false, 0 late, 0 early, 0 repeated\nmissed vf 3 0 0.5\n");
    EXPECT_EQ(
        impacts("vf 3 0 0.5\nee 0 1 3 4 0.25\nvf 3 0 0.5\nvf 4 0 1\nvf 3 0 0.5").out,
        "wrong: 1 impacts, 0 missed, 2 false, 0 late, 0 early, 1 repeated\nfalse vf 4 0 1\nfalse ee 0 1 3 4 0.25\n"
        "repeated vf 3 0 0.5\n");
    EXPECT_EQ(impacts("vf 3 0 0.5000000000000001").out,
              "wrong: 1 impacts, 0 missed, 0 false, 1 late, 0 early, 0 repeated\n"
              "late vf 3 0 0.5000000000000001, it is 0.5\n");
    EXPECT_EQ(impacts("vf 3 0 0.25").out,
              "wrong: 1 impacts, 0 missed, 0 false, 0 late, 1 early, 0 repeated\nearly vf 3 0 0.25, it is 0.5\n");
    for (const char* const rows : {"", "vf 3 0 0.5\nvf 4 0 1", "vf 3 0 0.75", "vf 3 0 0.25", "vf 3 0 0.5\nvf 3 0 0.5"})
        EXPECT_EQ(impacts(rows).status, 1) << rows;
}

TEST_F(VerifyFeatures, row_that_denies_contact_at_the_start_counts_as_late) {
    write("below.off", above_off);
    EXPECT_EQ(impacts("vf 3 0 0 1", "--min-distance 1").status, 0);
    EXPECT_EQ(impacts("vf 3 0 0", "--min-distance 1").status, 0);
    EXPECT_EQ(
        impacts("vf 3 0 0 0", "--min-distance 1").out,
        "wrong: 1 impacts, 0 missed, 0 false, 1 late, 0 early, 0 repeated\nlate vf 3 0 0, it is 0 at the start\n");
}

TEST_F(VerifyFeatures, wrong_distances_are_listed_as_far_or_close) {
    EXPECT_EQ(near("vf 3 0 1\n").out, "right: 1 near pairs, 0 missed, 0 false, 0 far, 0 close, 0 repeated\n");
    EXPECT_EQ(near("vf 3 0 1.5\n").out,
              "wrong: 1 near pairs, 0 missed, 0 false, 1 far, 0 close, 0 repeated\nfar vf 3 0 1.5, it is 1\n");
    EXPECT_EQ(near("vf 3 0 0.5\n").out,
              "wrong: 1 near pairs, 0 missed, 0 false, 0 far, 1 close, 0 repeated\nclose vf 3 0 0.5, it is 1\n");
    EXPECT_EQ(near("vf 3 0 1\n", "--below").out,
              "wrong: 0 near pairs, 0 missed, 1 false, 0 far, 0 close, 0 repeated\nfalse vf 3 0 1\n");
}

TEST_F(VerifyFeatures, near_pairs_can_be_limited_by_radii_rings_and_a_rest_shape) {
    write("radii.txt", "0.75\n0.75\n0.75\n0.75\n0.75\n0.75\n");
    ASSERT_EQ(crumple("near above.off --radii radii.txt -o list.txt").status, 0);
    EXPECT_TRUE(crumple("verify --radii radii.txt above.off list.txt").out.starts_with("right: 5 near pairs"));
    EXPECT_TRUE(crumple("verify --radius 1.5 --rings 1 above.off list.txt").out.starts_with("right: 5 near pairs"));
    write("radii.txt", "0.5\n0.5\n0.5\n0.5\n0.5\n0.5\n");
    EXPECT_EQ(crumple("verify --radii radii.txt above.off list.txt").status, 1);
    write("list.txt", "");
    EXPECT_TRUE(crumple("verify --radius 1.5 --rest above.off --rest-radius 1.5 above.off list.txt")
                    .out.starts_with("right: 0 near pairs"));
    EXPECT_EQ(crumple("verify --radius 1.5 --rest above.off above.off list.txt").status, 1);
}

TEST_F(VerifyFeatures, rows_and_vertices_can_have_any_order) {
    ASSERT_EQ(crumple("near above.off --radius 1.5 -o list.txt").status, 0);
    write("list.txt", "ee 3 4 2 0 2\nee 5 3 0 1 2\nee 0 1 3 4 2\nvf 3 0 1\nee 0 2 3 5 2\n");
    const Outcome outcome = crumple("verify --radius 1.5 above.off list.txt");
    EXPECT_EQ(outcome.status, 0) << outcome.out;
}

TEST_F(VerifyFeatures, candidates_of_one_file_or_a_step_can_be_verified) {
    write("list.txt", "ee 5 3 2 1\nvf 3 0\nee 1 2 3 4\n");
    Outcome outcome = crumple("verify --candidates above.off below.off list.txt");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "right: 3 candidates, 0 missed, 0 false, 0 repeated\n");
    write("list.txt", "ee 5 3 2 1\nvf 3 0\nvf 4 0\nvf 3 0\n");
    outcome = crumple("verify --candidates above.off below.off list.txt");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out,
              "wrong: 3 candidates, 1 missed, 1 false, 1 repeated\nmissed ee 1 2 3 4\nfalse vf 4 0\nrepeated vf 3 0\n");
    const std::string static_options = " --inflation 0.5 --kinds vertex_face,face_face";
    ASSERT_EQ(
        crumple("impacts above.off --candidates" + static_options + " -o a.txt -o a.csv -o a.json -o a.npz").status, 0);
    for (const char* const name : {"a.txt", "a.csv", "a.json", "a.npz"})
        EXPECT_EQ(crumple(std::string("verify --candidates above.off ") + name + static_options).out,
                  "right: 3 candidates, 0 missed, 0 false, 0 repeated\n");
    EXPECT_TRUE(crumple("verify --candidates above.off a.txt --inflation 0.5").out.starts_with("wrong: "))
        << "face_face is not requested";
    EXPECT_EQ(shell("$crumple verify --candidates above.off - --format json" + static_options + " < a.json").status, 0);
}

TEST_F(VerifyFeatures, wrong_arguments_are_refused) {
    write("list.txt", "vf 3 0 0.5 0\n");
    write("two.txt", "vf 0:3 1:0 0.5 0\n");
    expect_refused("verify --impacts above.off list.txt", "verify --impacts takes START, END and a list");
    expect_refused("verify --impacts --radius 1 above.off list.txt",
                   "--impacts, --candidates and --radius exclude each other");
    expect_refused("verify --impacts --candidates above.off list.txt", "exclude each other");
    expect_refused("verify --candidates --below above.off list.txt", "--below needs --radius");
    expect_refused("verify --inflation 0 above.off list.txt", "--inflation needs --candidates");
    expect_refused("verify --radius 1 --kinds face_face above.off list.txt", "--kinds needs --candidates");
    expect_refused("verify --candidates above.off list.txt --polygons", "--polygons does not go with --candidates");
    expect_refused("verify --candidates above.off list.txt", "list.txt, line 1: unexpected '0.5' after the last value");
    expect_refused("verify --min-distance 1 above.off list.txt",
                   "--min-distance, --min-distance-share and --approaching-only need --impacts");
    expect_refused("verify --below above.off list.txt", "--below needs --radius or --radii");
    expect_refused("verify --rings 1 above.off list.txt", "--rings needs --radius or --radii");
    expect_refused("verify --impacts --rest above.off above.off below.off list.txt",
                   "--rest needs --radius or --radii");
    expect_refused("verify --radius 1 --radii list.txt above.off list.txt", "--radius excludes --radii");
    expect_refused("verify --radii list.txt above.off below.off two.txt", "--radii does not support two meshes");
    expect_refused("verify --radii list.txt above.off list.txt --polygons", "--polygons does not go with --radii");
    expect_refused("verify --impacts above.off below.off two.txt", "ids of one mesh must have no file number");
    expect_refused("verify --radius 1 above.off below.off list.txt", "ids of two files must be 0:ID or 1:ID");
    expect_refused("verify --radius 1 above.off list.txt --format json", "--format is for a list from standard input");
    for (const char* const option : {"--neighbours skip", "--kind proper", "--part 1/1", "--polygons"})
        expect_refused(std::string("verify --impacts above.off below.off list.txt ") + option,
                       "does not go with --impacts");
    write("list.txt", "vf 3 0 0.5 0\nvf 3 zero 0.5\n");
    expect_refused("verify --impacts above.off below.off list.txt", "list.txt, line 2: 'zero' names no face");
}

}  // namespace
}  // namespace crumple::cli::test
