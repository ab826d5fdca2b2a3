#include "crumple/io.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

using Make = Cli;

TEST_F(Make, scenes_are_listed) {
    const Outcome outcome = crumple("make --list");
    EXPECT_EQ(outcome.status, 0);
    for (const char* scene : {"cloth ", "ground ", "soup ", "needles ", "five_decades ", "bodies ", "shells ", "fans ",
                              "lattice ", "cloth_on_ball ", "funnel ", "cutting "}) {
        EXPECT_TRUE(contains(outcome.out, scene)) << scene;
    }
    EXPECT_TRUE(contains(outcome.out, "92230      94"));
}

TEST_F(Make, scenes_are_written_as_ply_obj_stl_and_off) {
    for (const char* name : {"s.ply", "s.obj", "s.stl", "s.off"}) {
        EXPECT_EQ(crumple(std::string("make soup --triangles 321 -o ") + name).status, 0) << name;
        EXPECT_EQ(io::read_mesh(file(name)).triangle_count(), 321) << name;
    }
}

TEST_F(Make, last_frame_is_written_by_default) {
    crumple("make cloth --triangles 3000 -o last.ply");
    crumple("make cloth --triangles 3000 --frame 93 -o f93.ply");
    crumple("make cloth --triangles 3000 --frame 0 -o f0.ply");
    EXPECT_EQ(read("last.ply"), read("f93.ply"));
    EXPECT_NE(read("last.ply"), read("f0.ply"));
    EXPECT_EQ(crumple("detect f0.ply").out, "");
    EXPECT_NE(crumple("detect last.ply").out, "");
}

TEST_F(Make, all_frames_writes_one_file_per_frame) {
    EXPECT_EQ(crumple("make cutting --triangles 300 --all-frames -o c.ply").status, 0);
    EXPECT_LT(io::read_mesh(file("c000.ply")).triangle_count(), io::read_mesh(file("c119.ply")).triangle_count());
    for (int i = 0; i < 120; ++i) EXPECT_TRUE(fs::exists(file("c" + std::to_string(1000 + i).substr(1) + ".ply"))) << i;
    EXPECT_FALSE(fs::exists(file("c.ply")));
    EXPECT_FALSE(fs::exists(file("c120.ply")));
    crumple("make cutting --triangles 300 --frame 60 -o one.ply");
    EXPECT_EQ(read("one.ply"), read("c060.ply"));
}

TEST_F(Make, simulated_frames_are_cached) {
    const std::string make = "XDG_CACHE_HOME=$PWD/cache $crumple make cutting --triangles 5000 ";
    EXPECT_EQ(shell(make + "--frame 3 -o a.ply").status, 0);
    const fs::path cached = file("cache/crumple/cutting-5000-1/frame3");
    ASSERT_TRUE(fs::exists(cached));
    const auto time = fs::last_write_time(cached);
    EXPECT_EQ(shell(make + "--frame 3 -o b.ply").status, 0);
    EXPECT_EQ(read("a.ply"), read("b.ply"));
    EXPECT_TRUE(fs::last_write_time(cached) == time) << "simulated again";
}

TEST_F(Make, seed_changes_the_scene) {
    crumple("make soup --triangles 100 -o a.ply");
    crumple("make soup --triangles 100 --seed 1 -o b.ply");
    crumple("make soup --triangles 100 --seed 2 -o c.ply");
    EXPECT_EQ(read("a.ply"), read("b.ply"));
    EXPECT_NE(read("a.ply"), read("c.ply"));
}

TEST_F(Make, wrong_arguments_are_refused) {
    for (const char* wrong : {"make", "make clot -o x.ply", "make cloth", "make cloth --frame 94 -o x.ply",
                              "make cloth --frame -1 -o x.ply", "make soup --triangles 0 -o x.ply",
                              "make soup --triangles many -o x.ply", "make soup -o x.doc", "make soup -o no/where.ply",
                              "make --list soup", "make cutting --triangles 300 --all-frames --frame 3 -o x.ply",
                              "make cloth_on_ball -o x.doc", "make --list -o x.ply"}) {
        const Outcome outcome = crumple(wrong);
        EXPECT_EQ(outcome.status, 2) << wrong;
        EXPECT_TRUE(is_error_line(outcome.err)) << wrong << ": " << outcome.err;
        EXPECT_FALSE(fs::exists(file("x.ply"))) << wrong;
    }
    EXPECT_TRUE(contains(crumple("make clot -o x.ply").err, "cloth, ground"));
}

}  // namespace
}  // namespace crumple::cli::test
