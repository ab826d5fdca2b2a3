// Tests of crumple detect --groups bodies: bodies of glTF scenes and files, exclusions, many configurations.

#include <nlohmann/json.hpp>

#include "crumple/io.h"
#include "gltf_scene.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

class Bodies : public Cli {
   protected:
    Bodies() {
        write("robot.glb", crumple::test::robot_scene().glb());
        write("five.off", five_off);
        write("two.off", two_off);
    }
    /// Returns standard output of a run. Expects success, and no message on standard error unless the list is empty.
    std::string list(const std::string& arguments) const {
        const Outcome outcome = crumple("detect --groups bodies " + arguments);
        EXPECT_EQ(outcome.status, 0) << arguments;
        EXPECT_TRUE(reports_empty_list(outcome)) << arguments << outcome.err;
        return outcome.out;
    }
    void expect_refused(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = crumple("detect " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
    }
    /// Returns the row of a pose that only translates.
    static std::string at(double x, double y, double z) {
        const auto text = [](double v) { return std::to_string(v); };
        return "1,0,0," + text(x) + ",0,1,0," + text(y) + ",0,0,1," + text(z) + "\n";
    }
    /// Returns poses of four bodies in three configurations: all apart, only `arm` and `hand` in contact, all in
    /// contact.
    static std::string three_configurations() {
        std::string rows;
        for (const double step : {9.0, 0.0, 0.125}) {
            rows += at(step == 0 ? 20 : 0, 0, 0) + at(step, 0, 0) + at(2 * step + (step == 0 ? 0.125 : 0), 0, 0) +
                    at(step == 0 ? 40 : 3 * step, 0, 0);
        }
        return rows;
    }
};

TEST_F(Bodies, colliding_pairs_are_listed_by_name) {
    EXPECT_EQ(list("robot.glb"), "base\tarm\narm\thand\n");
    EXPECT_EQ(list("robot.glb --filter between"), "base\tarm\narm\thand\n");
    EXPECT_EQ(list("robot.glb --kind proper"), "arm\thand\n");
    EXPECT_EQ(list("robot.glb --weld"), "arm\thand\n") << "the corner that base and arm share is one vertex";
    EXPECT_EQ(list("robot.glb --backend reference"), "base\tarm\narm\thand\n");
    EXPECT_EQ(shell("cat robot.glb | $crumple detect - --groups bodies").out, "base\tarm\narm\thand\n");
}

TEST_F(Bodies, body_can_collide_with_itself) {
    crumple::test::GltfScene scene = crumple::test::robot_scene();
    scene.add_body("folded", scene.add_mesh({0, 0, 90, 4, 0, 90, 0, 4, 90, 1, 3, 90}, {0, 1, 2, 0, 1, 3}));
    write("folded.glb", scene.glb());
    EXPECT_EQ(list("folded.glb"), "base\tarm\narm\thand\n");
    EXPECT_EQ(list("folded.glb --filter within"), "folded\tfolded\n");
    EXPECT_EQ(list("folded.glb --filter both"), "base\tarm\narm\thand\nfolded\tfolded\n");
    EXPECT_EQ(list("folded.glb --filter both --excluded-bodies folded,folded"), "base\tarm\narm\thand\n");
}

TEST_F(Bodies, each_mesh_file_is_a_body_and_equal_names_get_numbers) {
    EXPECT_EQ(list("five.off two.off"), "five\ttwo\n");
    EXPECT_EQ(list("five.off two.off five.off"), "five\ttwo\nfive\tfive_2\ntwo\tfive_2\n");
    EXPECT_EQ(list("robot.glb robot.glb --filter between | grep far"), "far away\tfar away_2\n");
    EXPECT_EQ(crumple("detect five.off two.off").out, "0 1\n2 0\n3 1\n4 0\n") << "without --groups as ever";
}

TEST_F(Bodies, pairs_are_excluded_by_name) {
    EXPECT_EQ(list("robot.glb --excluded-bodies base,arm"), "arm\thand\n");
    EXPECT_EQ(list("robot.glb --excluded-bodies hand,arm --excluded-bodies base,arm"), "");
    write("all.txt", list("robot.glb"));
    EXPECT_EQ(list("robot.glb --excluded-bodies-from all.txt"), "");
    write("allowed.txt", "# the list\n\nbase arm\r\n\"hand\"\tarm\nfar away\tarm\n");
    EXPECT_EQ(list("robot.glb --excluded-bodies-from allowed.txt"), "");
    expect_refused("robot.glb --groups bodies --excluded-bodies base,amr",
                   "--excluded-bodies base,amr: there is no body amr; did you mean arm?");
    expect_refused("robot.glb --groups bodies --excluded-bodies far,arm", "no body far; did you mean far away?");
    expect_refused("robot.glb --groups bodies --excluded-bodies wheel,arm", "there is no body wheel\n");
    expect_refused("robot.glb --groups bodies --excluded-bodies base", "two names are expected, A,B");
    write("bad.txt", "base\tarm\nbase\tHand\n");
    expect_refused("robot.glb --groups bodies --excluded-bodies-from bad.txt",
                   "bad.txt, line 2: there is no body Hand; did you mean hand?");
    write("bad.txt", "base far away\n");
    expect_refused("robot.glb --groups bodies --excluded-bodies-from bad.txt",
                   "bad.txt, line 1: two names are expected");
}

TEST_F(Bodies, odd_names_are_quoted_and_read_back) {
    crumple::test::GltfScene scene;
    const int shape = scene.add_tetrahedron();
    for (const char* const name : {"a,b", "tab\there", "say \"x\"", " blank",
                                   "Kn\xc3\xb6"
                                   "chel"})
        scene.add_body(name, shape);
    write("odd.glb", scene.glb());
    const std::string all = list("odd.glb");
    EXPECT_TRUE(
        all.starts_with("a,b\t\"tab\\there\"\na,b\t\"say \\\"x\\\"\"\na,b\t\" blank\"\na,b\tKn\xc3\xb6"
                        "chel\n"))
        << all;
    write("all.txt", all);
    EXPECT_EQ(list("odd.glb --excluded-bodies-from all.txt"), "");
    EXPECT_FALSE(contains(list("odd.glb --excluded-bodies a,b,Kn\xc3\xb6"
                               "chel"),
                          "a,b\tKn"));
    const Outcome outcome = crumple("detect odd.glb --groups bodies -o odd.csv -o odd.json");
    EXPECT_TRUE(contains(read("odd.csv"), "\"a,b\",\"say \"\"x\"\"\"\n")) << read("odd.csv");
    EXPECT_EQ(nlohmann::json::parse(read("odd.json"))["pairs"][0], (nlohmann::json{"a,b", "tab\there"}));
    EXPECT_EQ(list("odd.glb --excluded-bodies-from odd.csv"), "");
    EXPECT_EQ(list("odd.glb --excluded-bodies-from odd.json"), "");
    write("bad.csv", "first,second\n\"a,b\",none\n");
    expect_refused("odd.glb --groups bodies --excluded-bodies-from bad.csv", "bad.csv, line 2: there is no body none");
    write("bad.csv", "first,second\na\n");
    expect_refused("odd.glb --groups bodies --excluded-bodies-from bad.csv", "bad.csv, line 2: two names are expected");
    write("bad.json", "a\tb\n");
    expect_refused("odd.glb --groups bodies --excluded-bodies-from bad.json", "bad.json, byte 0: this is not JSON");
    write("bad.json", "[1]");
    expect_refused("odd.glb --groups bodies --excluded-bodies-from bad.json",
                   "bad.json, byte 0: an object with a list of pairs");
}

TEST_F(Bodies, pairs_of_bodies_are_written_as_text_csv_and_json) {
    const Outcome outcome = crumple("detect robot.glb --groups bodies -o p.txt -o p.csv -o p.json");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("2 pairs of bodies, 3 of 4 bodies, ")) << outcome.err;
    EXPECT_EQ(read("p.txt"), "base\tarm\narm\thand\n");
    EXPECT_EQ(read("p.csv"), "first,second\nbase,arm\narm,hand\n");
    const auto json = nlohmann::json::parse(read("p.json"));
    EXPECT_EQ(json["bodies"].dump(), R"(["base","arm","hand","far away"])");
    EXPECT_EQ(json["pairs"].dump(), R"([["base","arm"],["arm","hand"]])");
    EXPECT_TRUE(json["milliseconds"].is_number());
    EXPECT_EQ(list("robot.glb -o - --format csv"), "first,second\nbase,arm\narm,hand\n");
    EXPECT_TRUE(crumple("detect five.off --groups bodies -o p.txt").err.starts_with("nothing collides: 1 body, "));
}

TEST_F(Bodies, coloured_glb_keeps_names_and_poses) {
    ASSERT_EQ(crumple("detect robot.glb --groups bodies -o c.glb -o c.ply -o c.html -o c.obj").status, 0);
    EXPECT_EQ(list("c.glb"), "base\tarm\narm\thand\n") << "names and poses are kept";
    const io::WorldMesh world = io::read_world(file("c.glb"));
    const io::WorldMesh original = io::read_world(file("robot.glb"));
    ASSERT_EQ(world.bodies.size(), original.bodies.size());
    for (std::size_t i = 0; i < original.bodies.size(); ++i) {
        EXPECT_EQ(world.bodies[i].name, original.bodies[i].name);
        EXPECT_EQ(world.bodies[i].pose, original.bodies[i].pose) << original.bodies[i].name;
    }
    EXPECT_EQ(io::read_mesh(file("c.ply")).triangle_count(), 16);
    EXPECT_EQ(shell("$crumple detect robot.glb --groups bodies -o - --format glb > d.glb").status, 0);
    EXPECT_EQ(read("d.glb"), read("c.glb"));
    expect_refused("robot.glb --groups bodies -o x.npz", "bodies are written as .txt, .csv or .json");
    expect_refused("robot.glb --groups bodies -o robot.glb", "would overwrite the input robot.glb");
}

TEST_F(Bodies, check_reports_collisions_by_exit_status) {
    EXPECT_EQ(crumple("detect robot.glb --groups bodies --check").status, 1);
    EXPECT_EQ(crumple("detect robot.glb --groups bodies --check").out, "something collides\n");
    EXPECT_EQ(crumple("detect five.off --groups bodies --check").status, 0);
    EXPECT_EQ(crumple("detect five.off --groups bodies --check").out, "nothing collides\n");
    EXPECT_EQ(crumple("detect robot.glb --groups bodies --check -o p.txt").status, 1);
}

TEST_F(Bodies, one_run_checks_several_configurations) {
    write("poses.csv", three_configurations());
    EXPECT_EQ(list("robot.glb --poses poses.csv"), "configuration,collides,pairs\n0,0,0\n1,1,1\n2,1,6\n");
    EXPECT_EQ(list("robot.glb --poses poses.csv --excluded-bodies arm,hand"),
              "configuration,collides,pairs\n0,0,0\n1,0,0\n2,1,5\n");
    EXPECT_EQ(list("robot.glb --poses poses.csv --any-by-world"), "configuration,collides\n0,0\n1,1\n2,1\n");
    EXPECT_EQ(list("robot.glb --poses poses.csv --backend reference"), list("robot.glb --poses poses.csv"));
    EXPECT_EQ(shell("$crumple detect robot.glb --groups bodies --poses - < poses.csv").out,
              list("robot.glb --poses poses.csv"));
    const Outcome outcome = crumple("detect robot.glb --groups bodies --poses poses.csv -o p.txt -o p.json");
    EXPECT_TRUE(outcome.err.starts_with("2 of 3 configurations collide, ")) << outcome.err;
    EXPECT_EQ(read("p.txt"), "0 no 0\n1 yes 1\n2 yes 6\n");
    const auto json = nlohmann::json::parse(read("p.json"));
    EXPECT_EQ(json["configurations"][1].dump(), R"({"collides":true,"pairs":[["arm","hand"]]})");
    EXPECT_EQ(crumple("detect robot.glb --groups bodies --check --poses poses.csv").status, 1);
    EXPECT_EQ(crumple("detect robot.glb --groups bodies --check --poses poses.csv").out, "something collides\n");
    write("none.csv", "");
    EXPECT_EQ(list("robot.glb --poses none.csv"), "configuration,collides,pairs\n");
}

TEST_F(Bodies, rows_of_60000_configurations_keep_their_order) {
    std::string rows;
    for (int i = 0; i < 20'000; ++i) rows += three_configurations();
    write("many.csv", rows);
    const Outcome outcome = crumple("detect robot.glb --groups bodies --excluded-bodies base,hand --poses many.csv");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::string expected = "configuration,collides,pairs\n";
    for (int c = 0; c < 60'000; ++c)
        expected += std::to_string(c) + (c % 3 == 0 ? ",0,0\n" : c % 3 == 1 ? ",1,1\n" : ",1,5\n");
    EXPECT_TRUE(outcome.out == expected);
}

TEST_F(Bodies, error_in_poses_names_the_place) {
    const auto refused = [&](const std::string& rows, const std::string& reason) {
        write("p.csv", rows);
        expect_refused("robot.glb --groups bodies --poses p.csv", reason);
    };
    const std::string good = three_configurations();
    refused(good + "1,2,3\n",
            "p.csv, line 13: row 12 (configuration 3, body 'base'): a pose must have 12 or 16 numbers, not 3");
    refused(good + at(0, 0, 0) + "1,0,0,nan,0,1,0,0,0,0,1,0\n",
            "p.csv, line 14: row 13 (configuration 3, body 'arm'): number 4 is not finite");
    refused(good + "1,0,0,x,0,1,0,0,0,0,1,0\n", "p.csv, line 13: 'x' is not a number");
    refused(good + at(0, 0, 0), "p.csv: 13 rows for 4 bodies: the last configuration has 1");
    refused(at(0, 0, 0) + at(5, 0, 0) + at(9, 0, 0) + at(20, 0, 0) + at(0, 0, 0) + at(0, 0, 0) + at(1e308, 0, 0) +
                at(0, 0, 0),
            "configuration 1, body 'hand': vertex");
    expect_refused("robot.glb --groups bodies --poses none.csv", "none.csv");
    std::string many;  // more configurations than are searched at once
    for (int i = 0; i < 10'000; ++i) many += good;
    refused(many + at(1e308, 0, 0) + at(0, 0, 0) + at(0, 0, 0) + at(0, 0, 0),
            "configuration 30000, body 'base': vertex");
}

TEST_F(Bodies, info_lists_bodies) {
    const Outcome outcome = crumple("info robot.glb");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out,
                         "bodies                4\nshapes                1\ntriangles             16\n"
                         "unit                  m\n"));
    for (const char* const body : {"\nbody 0                base\n", "\nbody 1                arm\n",
                                   "\nbody 2                hand\n", "\nbody 3                far away\n"})
        EXPECT_TRUE(contains(outcome.out, body)) << outcome.out;
    const std::string last = outcome.out.substr(outcome.out.find("body 3 "));
    EXPECT_TRUE(contains(last, "body 3                far away\nshape                 0\n")) << last;
    EXPECT_TRUE(contains(last, "closed                yes\nvolume                0.166667 m^3\n")) << last;
    EXPECT_EQ(crumple("info robot.glb --check").status, 0);
    EXPECT_EQ(shell("cat robot.glb | $crumple info -").out, outcome.out);
}

TEST_F(Bodies, scene_is_searched_as_one_mesh_without_the_groups_option) {
    EXPECT_EQ(crumple("convert robot.glb robot.ply").status, 0);
    const Outcome scene = crumple("detect robot.glb"), mesh = crumple("detect robot.ply");
    EXPECT_EQ(scene.status, 0) << scene.err;
    EXPECT_FALSE(scene.out.empty());
    EXPECT_EQ(scene.out, mesh.out);
    EXPECT_EQ(crumple("near robot.glb --radius 0.01").out, crumple("near robot.ply --radius 0.01").out);
}

TEST_F(Bodies, summary_reports_that_nothing_collides) {
    EXPECT_TRUE(
        contains(crumple("detect robot.glb --groups bodies --excluded-bodies base,arm --excluded-bodies arm,hand").err,
                 "nothing collides: 4 bodies"));
}

TEST_F(Bodies, strict_turns_the_warning_about_a_skin_into_an_error) {
    crumple::test::GltfScene scene = crumple::test::robot_scene();
    scene.json["nodes"][1]["skin"] = 0;
    write("skin.glb", scene.glb());
    const Outcome outcome = crumple("detect skin.glb --groups bodies");
    EXPECT_EQ(outcome.out, "base\tarm\narm\thand\n");
    EXPECT_TRUE(contains(outcome.err, "crumple: warning: skin.glb: nodes[1] has a skin")) << outcome.err;
    expect_refused("skin.glb --groups bodies --strict", "nodes[1] has a skin");
}

TEST_F(Bodies, incompatible_options_are_refused) {
    write("poses.csv", three_configurations());
    expect_refused("robot.glb --excluded-bodies base,arm", "--excluded-bodies needs --groups bodies");
    expect_refused("five.off --excluded-bodies-from x", "--excluded-bodies-from needs --groups bodies");
    expect_refused("five.off --poses x", "--poses needs --groups bodies");
    expect_refused("robot.glb --groups bodies --any-by-world", "--any-by-world needs --poses");
    expect_refused("robot.glb --groups bodies --contacts", "--contacts does not go with --groups bodies");
    expect_refused("robot.glb --groups bodies --polygons", "--polygons");
    expect_refused("robot.glb --groups bodies --part 1/2", "--part does not go with --groups bodies");
    expect_refused("robot.glb --groups bodies --stats", "--stats does not go with --groups bodies");
    expect_refused("robot.glb --groups bodies --poses poses.csv -o x.glb", "with --poses, rows are written");
    expect_refused("robot.glb --groups bodies --poses poses.csv -o poses.csv", "would overwrite the input poses.csv");
    expect_refused("- --groups bodies --poses -", "standard input, -, can be read only once");
    EXPECT_TRUE(contains(crumple("sequence five.off --groups bodies --filter between").err, "is for crumple detect"));
}

}  // namespace
}  // namespace crumple::cli::test
