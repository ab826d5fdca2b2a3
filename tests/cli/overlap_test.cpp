// Tests of crumple overlap and verify --overlaps on boxes that are stacked, apart, nested, equal and open.

#include <array>
#include <nlohmann/json.hpp>

#include "gltf_scene.h"
#include "off_boxes.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

/// Returns a box whose triangles share no vertices, in STL or OFF.
std::string unshared(const Corner& low, const Corner& high, bool stl) {
    const std::vector<Corner> corners = box_corners(low, high);
    std::ostringstream out, faces;
    out << (stl ? "solid box\n" : "OFF\n36 12 0\n");
    int vertex = 0;
    for (const auto& triangle : box_triangles) {
        if (stl) out << "facet normal 0 0 0\nouter loop\n";
        for (const int corner : triangle) {
            const auto& [x, y, z] = corners[static_cast<std::size_t>(corner)];
            out << (stl ? "vertex " : "") << x << ' ' << y << ' ' << z << '\n';
        }
        if (stl) out << "endloop\nendfacet\n";
        faces << "3 " << vertex << ' ' << vertex + 1 << ' ' << vertex + 2 << '\n';
        vertex += 3;
    }
    return out.str() + (stl ? "endsolid box\n" : faces.str());
}

constexpr const char* low_high = "low,high,overlapping,0.25,0.5,0.5,0.875,0,0,1,0,0,1,0.25,0,0,0,0.5,0.5,0.875,1\n";
constexpr const char* heading =
    "first,second,relation,volume,centroid_x,centroid_y,centroid_z,area_vector_x,area_vector_y,area_vector_z,normal_x,"
    "normal_y,normal_z,mean_depth,torque_x,torque_y,torque_z,torque_point_x,torque_point_y,torque_point_z,contact_"
    "area\n";

class Overlap : public Cli {
   protected:
    Overlap() {
        write("low.off", box_off({0, 0, 0}, {1, 1, 1}));
        write("high.off", box_off({0, 0, 0.75}, {1, 1, 1.75}));
        write("on.off", box_off({0, 0, 1}, {1, 1, 2}));
        write("small.off", box_off({0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}));
        write("far.off", box_off({5, 5, 5}, {6, 6, 6}));
        write("open.off", box_off({0, 0, 0.75}, {1, 1, 1.75}, 10));
    }
    /// Returns standard output of a run. Expects success, and one line on standard error that begins with `summary`.
    std::string text(const std::string& arguments, const std::string& summary) const {
        const Outcome outcome = crumple("overlap " + arguments);
        EXPECT_EQ(outcome.status, 0) << arguments;
        EXPECT_TRUE(outcome.err.starts_with(summary)) << arguments << ": " << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        return outcome.out;
    }
    void expect_refused(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = crumple(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
    }
    /// Runs verify on a list of overlaps of `low` and `high`.
    Outcome verify(const std::string& rows, const std::string& options = "") const {
        write("list.csv", rows);
        return crumple("verify --overlaps low.off high.off list.csv " + options);
    }
};

TEST_F(Overlap, relations_of_closed_bodies_are_printed_in_words) {
    EXPECT_EQ(text("low.off high.off", "1 pair of bodies (1 overlapping), 2 of 2 bodies, "),
              "low and high overlap: volume 0.25, mean depth 0.25, normal (0 0 1)\n");
    EXPECT_EQ(text("low.off on.off", "1 pair of bodies (1 touching), "),
              "low and on touch: volume 0, mean depth 0, normal (0 0 1)\n");
    EXPECT_EQ(text("low.off small.off", "1 pair of bodies (1 nested), "), "small lies inside low: volume 0.015625\n");
    EXPECT_EQ(text("small.off low.off", "1 pair of bodies (1 nested), "), "small lies inside low: volume 0.015625\n");
    EXPECT_EQ(text("low.off low.off", "1 pair of bodies (1 equal), "), "low and low_2 fill the same space: volume 1\n");
    EXPECT_EQ(text("low.off far.off", "nothing overlaps: 2 bodies, "), "");
    EXPECT_EQ(text("low.off on.off small.off far.off", "2 pairs of bodies (1 touching, 1 nested), 3 of 4"),
              "low and on touch: volume 0, mean depth 0, normal (0 0 1)\nsmall lies inside low: volume 0.015625\n");
}

TEST_F(Overlap, regions_depths_and_withdrawals_are_printed_and_written) {
    write("pin.off", box_off({0.25, 0.25, 0.75}, {0.75, 0.75, 1.75}));
    const std::string parts = "--regions --depth-tolerance 0.01 --withdraw 0,0,2 --withdraw -1,0,0 ";
    const std::string printed = text("low.off pin.off " + parts, "1 pair");
    EXPECT_TRUE(contains(printed, "\n  greatest depth between 0.25 and 0.25")) << printed;
    EXPECT_TRUE(contains(printed,
                         "\n  direction 0: the second body is past the first one after 0.125 times the direction\n"
                         "  direction 1: the second body is past the first one after 0.75 times the direction\n"))
        << printed;
    EXPECT_TRUE(
        contains(printed, "\n  region 0: volume 0.0625, thickness 0.25, from (0.25 0.25 0.75) to (0.75 0.75 1)\n"))
        << printed;
    ASSERT_EQ(crumple("overlap low.off pin.off far.off " + parts + "-o a.json -o a.npz").status, 0);
    const auto json = nlohmann::json::parse(read("a.json"));
    EXPECT_EQ(json["withdrawals"].dump(), "[0.125,0.75]");
    EXPECT_EQ(json["depth_tolerance"].dump(), "[0.01]");
    EXPECT_EQ(json["directions"].dump(), "[[0,0,2],[-1,0,0]]");
    EXPECT_EQ(json["region_rows"].dump(), "[0]");
    EXPECT_EQ(json["region_box"].dump(), "[[0.25,0.25,0.75,0.75,0.75,1]]");
    EXPECT_LE(json["depth_reached"][0].get<double>(), 0.25);
    EXPECT_GE(json["depth_bound"][0].get<double>(), 0.25);
    for (const char* const array : {"region_rows", "region_volume", "region_thickness", "withdrawals", "depth_bound"})
        EXPECT_TRUE(contains(read("a.npz"), std::string(array) + ".npy")) << array;
    EXPECT_EQ(crumple("verify --overlaps low.off pin.off far.off a.json").status, 0);
}

TEST_F(Overlap, first_free_motion_is_printed_and_written) {
    write("peg.off", box_off({0.25, 0.25, 0.75}, {0.75, 0.75, 1.75}));
    write("slabs.off", two_boxes({0, 0, 0}, {1, 1, 1}, {0, 0, 4}, {1, 1, 5}));
    const std::string parts = "slabs.off peg.off --withdraw 0,0,2 --withdraw -1,0,0 --first-free ";
    EXPECT_TRUE(contains(text(parts, "1 pair"),
                         "\n  direction 0: the second body first does not overlap the first one at 0.125, and is past "
                         "it after 2.125 times the "
                         "direction\n  direction 1: the second body first does not overlap the first one at 0.75, and "
                         "is past it after 0.75 times "
                         "the direction\n"));
    ASSERT_EQ(crumple("overlap " + parts + "-o a.json -o a.npz").status, 0);
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["first_free"].dump(), "[0.125,0.75]");
    EXPECT_TRUE(contains(read("a.npz"), "first_free.npy"));
}

TEST_F(Overlap, verify_checks_regions_depths_and_withdrawals) {
    write("pin.off", box_off({0.25, 0.25, 0.75}, {0.75, 0.75, 1.75}));
    const std::string bodies = "low.off pin.off low.off ";
    const std::string parts = "--regions --depth-tolerance 0.01 --withdraw 0,0,2 --withdraw -1,0,0 --first-free ";
    ASSERT_EQ(crumple("overlap " + bodies + parts + "-o a.json -o a.npz").status, 0);
    for (const char* const name : {"a.json", "a.npz"}) {
        const Outcome verified = crumple("verify --overlaps " + bodies + name);
        EXPECT_EQ(verified.status, 0) << verified.out;
    }
    const auto expect_wrong = [&](auto change, const std::string& text) {
        auto json = nlohmann::json::parse(read("a.json"));
        change(json);
        write("b.json", json.dump());
        const Outcome verified = crumple("verify --overlaps " + bodies + "b.json");
        EXPECT_EQ(verified.status, 1) << text;
        EXPECT_TRUE(contains(verified.out, "1 of other numbers")) << verified.out;
        EXPECT_TRUE(contains(verified.out, text)) << verified.out;
    };
    expect_wrong([](auto& json) { json["withdrawals"][1] = 0.5; },
                 "low and pin: withdrawals 0.125 0.5, it is 0.125 0.75");
    expect_wrong([](auto& json) { json["first_free"][0] = 0; }, "low and pin: first_free 0 0.75, it is 0.125 0.75");
    expect_wrong([](auto& json) { json["depth_bound"][0] = 7; }, "low and pin: depth_bound 7, it is 0.25");
    expect_wrong([](auto& json) { json["depth_reached"][0] = nullptr; }, "low and pin: depth_reached nan, it is ");
    expect_wrong([](auto& json) { json["region_volume"][0] = 1; }, "region 0: region_volume 1, it is 0.0625");
    expect_wrong(
        [](auto& json) {
            for (auto& [name, values] : json.items())
                if (name.starts_with("region_")) values.erase(values.begin());
        },
        "low and pin: 0 regions, it has 1");
    const auto expect_invalid = [&](auto change, const std::string& text) {
        auto json = nlohmann::json::parse(read("a.json"));
        change(json);
        write("b.json", json.dump());
        expect_refused("verify --overlaps " + bodies + "b.json", "b.json: " + text);
    };
    expect_invalid([](auto& json) { json["withdrawals"].erase(0); }, "\"withdrawals\" must have 6 rows");
    expect_invalid([](auto& json) { json.erase("withdrawals"); }, "there is no array \"withdrawals\"");
    expect_invalid(
        [](auto& json) {
            json["directions"][1] = {0, 0, 0};
        },
        "row 1 of \"directions\": this is not a direction");
    expect_invalid([](auto& json) { json["depth_tolerance"][0] = 0; },
                   "row 0 of \"depth_tolerance\": this is not a tolerance");
    expect_invalid([](auto& json) { json["region_rows"][0] = 3; }, "row 0 of \"region_rows\": there is no such row");
}

TEST_F(Overlap, backends_and_thread_counts_give_the_same_bytes) {
    const std::string files = "low.off high.off on.off small.off -o - --format csv ";
    const std::string one = crumple("overlap " + files + "--threads 1").out;
    EXPECT_TRUE(one.starts_with(std::string(heading) + low_high)) << one;
    EXPECT_EQ(crumple("overlap " + files + "--threads 2").out, one);
    EXPECT_EQ(crumple("overlap " + files + "--backend reference").out, one);
}

TEST_F(Overlap, numbers_are_printed_with_the_unit) {
    EXPECT_EQ(text("low.off high.off --unit mm", "1 pair"),
              "low and high overlap: volume 0.25 mm^3, mean depth 0.25 mm, normal (0 0 1)\n");
    ASSERT_EQ(crumple("overlap low.off high.off --unit mm -o a.json").status, 0);
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["unit"], "mm");
}

TEST_F(Overlap, poses_of_bodies_in_a_scene_are_applied) {
    // Three tetrahedra, two of them moved along x: by 0.5, and far away.
    crumple::test::GltfScene scene;
    const int shape = scene.add_tetrahedron();
    scene.add_body("fixed", shape);
    scene.add_body("arm, left", shape, {0.5, 0, 0});
    scene.add_body("away", shape, {9, 0, 0});
    write("robot.glb", scene.glb());
    const std::string line = text("robot.glb", "1 pair of bodies (1 overlapping), 2 of 3 bodies, ");
    EXPECT_TRUE(line.starts_with("fixed and arm, left overlap: volume 0.0208333 m^3, mean depth ")) << line;
    EXPECT_EQ(text("robot.glb --excluded-bodies 'arm, left,fixed'", "nothing overlaps: 3 bodies"), "");
    write("allowed.txt", "fixed\tarm, left\n");
    EXPECT_EQ(text("robot.glb --excluded-bodies-from allowed.txt", "nothing overlaps: 3 bodies"), "");
    EXPECT_EQ(shell("$crumple overlap - < robot.glb").out, line);
    ASSERT_EQ(crumple("overlap robot.glb -o a.csv").status, 0);
    EXPECT_TRUE(contains(read("a.csv"), "\nfixed,\"arm, left\",overlapping,0.0208333333333")) << read("a.csv");
    EXPECT_EQ(crumple("verify --overlaps robot.glb a.csv").status, 0);
}

TEST_F(Overlap, rows_name_their_configuration) {
    const std::string fixed = "1,0,0,0,0,1,0,0,0,0,1,0\n";
    write("poses.csv", fixed + "1,0,0,9,0,1,0,0,0,0,1,0\n" + fixed + fixed + fixed + "1,0,0,0,0,1,0,0,0,0,1,0.25\n");
    const std::string with_poses = "low.off high.off --poses poses.csv ";
    const std::string summary = "2 pairs of bodies (1 touching, 1 overlapping), 2 of 2 bodies";
    EXPECT_EQ(text(with_poses, summary),
              "configuration 1: low and high overlap: volume 0.25, mean depth 0.25, normal (0 0 1)\n"
              "configuration 2: low and high touch: volume 0, mean depth 0, normal (0 0 1)\n");
    EXPECT_EQ(text(with_poses + "--any-by-world", "bodies overlap or touch in 2 of 3 configurations"),
              "configuration,overlaps\n0,0\n1,1\n2,1\n");
    EXPECT_EQ(text(with_poses + "--any-by-world --min-volume 0.1", "bodies overlap or touch in 1 of 3"),
              "configuration,overlaps\n0,0\n1,1\n2,0\n");
    EXPECT_EQ(crumple("overlap " + with_poses + "--check").status, 1);
    for (const std::string name : {"a.csv", "a.json", "a.npz"}) {
        ASSERT_EQ(crumple("overlap " + with_poses + "-o " + name).status, 0);
        EXPECT_EQ(crumple("verify --overlaps low.off high.off --poses poses.csv " + name).out,
                  "right: 2 overlaps, 0 missed, 0 false, 0 of another relation, 0 of other numbers, 0 repeated\n");
    }
    EXPECT_TRUE(contains(read("a.csv"), "\n1,low,high,overlapping,0.25,"));
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["configuration"].dump(), "[1,2]");
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["bodies"].dump(), "[[0,1],[0,1]]");
}

TEST_F(Overlap, csv_json_and_npz_read_back_exactly) {
    // Coordinates that have no short decimal form.
    write("third.off", box_off({1. / 3, 1. / 7, -1. / 9}, {11. / 13, 2, 0.1}));
    const std::string files = "low.off third.off high.off on.off small.off ";
    ASSERT_EQ(crumple("overlap " + files + "-o a.csv -o a.json -o a.npz -o a.txt").status, 0);
    for (const std::string name : {"a.csv", "a.json", "a.npz"})
        EXPECT_EQ(crumple("verify --overlaps " + files + name).out,
                  "right: 5 overlaps, 0 missed, 0 false, 0 of another relation, 0 of other numbers, 0 repeated\n")
            << name;
    EXPECT_EQ(shell("$crumple overlap " + files + "-o - --format json | $crumple verify --overlaps " + files +
                    "- --format json")
                  .status,
              0);
    EXPECT_EQ(read("a.txt"), crumple("overlap " + files).out);
    expect_refused("verify --overlaps " + files + "a.txt", "a.txt: lists of overlaps are read as .csv, .json or .npz");
    const auto json = nlohmann::json::parse(read("a.json"));
    EXPECT_EQ(json["names"].dump(), R"(["low","third","high","on","small"])");
    EXPECT_EQ(json["relation"].size(), 5u);
    EXPECT_EQ(json["unit"], nullptr);
    for (const char* const array : {"bodies", "relation", "volume", "centroid", "area_vector", "normal", "mean_depth",
                                    "torque", "torque_point", "contact_area"})
        EXPECT_TRUE(contains(read("a.npz"), std::string(array) + ".npy")) << array;
}

TEST_F(Overlap, missing_numbers_are_empty_in_csv_and_null_in_json) {
    ASSERT_EQ(crumple("overlap low.off small.off -o a.csv -o a.json").status, 0);
    EXPECT_EQ(read("a.csv"), heading + std::string("low,small,second_inside,0.015625,0.375,0.375,0.375,0,0,0,,,,,0,0,0,"
                                                   "0.375,0.375,0.375,0\n"));
    EXPECT_EQ(nlohmann::json::parse(read("a.json"))["normal"].dump(), "[[null,null,null]]");
    EXPECT_EQ(crumple("verify --overlaps low.off small.off a.csv").status, 0);
    EXPECT_EQ(crumple("verify --overlaps low.off small.off a.json").status, 0);
}

TEST_F(Overlap, body_pairs_list_only_relations) {
    EXPECT_EQ(text("low.off high.off --body-pairs", "1 pair of bodies (1 overlapping)"), "low and high overlap\n");
    ASSERT_EQ(crumple("overlap low.off high.off --body-pairs -o a.csv -o a.json -o a.npz").status, 0);
    EXPECT_EQ(read("a.csv"), "first,second,relation\nlow,high,overlapping\n");
    EXPECT_FALSE(nlohmann::json::parse(read("a.json")).contains("volume"));
    for (const std::string name : {"a.csv", "a.json", "a.npz"})
        EXPECT_EQ(crumple("verify --overlaps low.off high.off " + name).status, 0) << name;
}

TEST_F(Overlap, volumes_below_the_minimum_are_excluded) {
    EXPECT_EQ(text("low.off high.off --min-volume 0.25", "1 pair"),
              "low and high overlap: volume 0.25, mean depth 0.25, normal (0 0 1)\n");
    EXPECT_EQ(text("low.off high.off --min-volume 0.2500000000000001", "nothing overlaps"), "");
    EXPECT_EQ(text("low.off on.off --min-volume 1e-300", "nothing overlaps"), "");
    for (const char* const bad : {"-1", "inf", "nan", "1mm"})
        expect_refused(std::string("overlap low.off high.off --min-volume ") + bad,
                       std::string(bad) + " is not a volume of 0 or more");
}

TEST_F(Overlap, check_reports_overlaps_by_exit_status) {
    Outcome outcome = crumple("overlap low.off high.off --check");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "something overlaps\n");
    EXPECT_EQ(outcome.err, "");
    outcome = crumple("overlap low.off far.off --check");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "nothing overlaps\n");
    EXPECT_EQ(crumple("overlap low.off on.off --check").status, 1) << "what touches has a row";
    EXPECT_EQ(crumple("overlap low.off on.off --check --min-volume 0.1").status, 0);
    EXPECT_EQ(crumple("overlap low.off high.off --check -o a.csv").status, 1);
    EXPECT_EQ(read("a.csv"), heading + std::string(low_high));
    outcome = crumple("overlap low.off high.off --check --stats");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(contains(outcome.err, "1 overlapping\n")) << outcome.err;
}

TEST_F(Overlap, stl_is_welded_by_default_and_other_seams_need_weld) {
    write("part.stl", unshared({0, 0, 0.75}, {1, 1, 1.75}, true));
    write("seams.off", unshared({0, 0, 0.75}, {1, 1, 1.75}, false));
    EXPECT_EQ(text("low.off part.stl", "1 pair"),
              "low and part overlap: volume 0.25, mean depth 0.25, normal (0 0 1)\n");
    EXPECT_EQ(text("low.off seams.off --weld", "1 pair"),
              "low and seams overlap: volume 0.25, mean depth 0.25, normal (0 0 1)\n");
    expect_refused("overlap low.off seams.off", "seams.off: body 'seams': its surface is not closed: 36 edges");
    expect_refused("overlap low.off part.stl --no-weld", "part.stl: body 'part': its surface is not closed");
}

TEST_F(Overlap, open_bodies_whose_inside_matters_are_errors_unless_skipped) {
    expect_refused("overlap low.off open.off", "open.off: body 'open': its surface is not closed: 4 edges");
    expect_refused("overlap low.off open.off",
                   "info --open-edges lists them all, --weld closes seams, --open skip leaves such bodies out");
    expect_refused("overlap low.off open.off --open error", "open.off: body 'open'");
    EXPECT_EQ(text("open.off far.off", "nothing overlaps"), "") << "no winding number is needed";
    const Outcome outcome = crumple("overlap low.off open.off small.off --open skip");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "small lies inside low: volume 0.015625\n");
    EXPECT_TRUE(outcome.err.starts_with("crumple: note: this body is not closed, and left out: open\n")) << outcome.err;
    write("poses.csv",
          "1 0 0 9 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
    expect_refused("overlap low.off open.off --poses poses.csv", "open.off: configuration 1, body 'open'");
}

TEST_F(Overlap, verify_lists_mistakes_by_kind) {
    const std::string right = heading + std::string(low_high);
    EXPECT_EQ(verify(right).out,
              "right: 1 overlaps, 0 missed, 0 false, 0 of another relation, 0 of other numbers, 0 repeated\n");
    EXPECT_EQ(verify(heading).out,
              "wrong: 1 overlaps, 1 missed, 0 false, 0 of another relation, 0 of other numbers, 0 repeated\n"
              "missed low and high\n");
    EXPECT_EQ(verify(right + low_high).out,
              "wrong: 1 overlaps, 0 missed, 0 false, 0 of another relation, 0 of other numbers, 1 repeated\n"
              "repeated low and high\n");
    EXPECT_EQ(verify("low,high,equal\n").out,
              "wrong: 1 overlaps, 0 missed, 0 false, 1 of another relation, 0 of other numbers, 0 repeated\n"
              "relation of low and high: equal, it is overlapping\n");
    EXPECT_EQ(
        verify("low,high,overlapping,0.25000000000000006,0.5,0.5,0.875,0,0,1,0,0,1,0.25,0,0,0,0.5,0.5,0.875,1\n").out,
        "wrong: 1 overlaps, 0 missed, 0 false, 0 of another relation, 1 of other numbers, 0 repeated\n"
        "numbers of low and high: volume 0.25000000000000006, it is 0.25\n");
    EXPECT_EQ(verify("low,high,overlapping,0.25,0.5,0.5,0.875,0,0,1,0,0,,0.25,0,0,0,0.5,0.5,0.875,1\n").out,
              "wrong: 1 overlaps, 0 missed, 0 false, 0 of another relation, 1 of other numbers, 0 repeated\n"
              "numbers of low and high: normal 0 0 nan, it is 0 0 1\n");
    EXPECT_EQ(verify(right, "--excluded-bodies low,high").out,
              "wrong: 0 overlaps, 0 missed, 1 false, 0 of another relation, 0 of other numbers, 0 repeated\n"
              "false low and high\n");
    EXPECT_EQ(verify(right).status, 0);
    EXPECT_EQ(verify(right, "--min-volume 1").status, 1);
}

TEST_F(Overlap, single_body_is_tested_for_self_overlap) {
    EXPECT_EQ(text("low.off", "the body does not overlap itself: "), "");
    write("twice.off", two_boxes({0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}));
    EXPECT_EQ(text("twice.off --unit mm", "1 body overlaps itself, 1 of 1 bodies, "),
              "twice overlaps itself: volume 0.125 mm^3\n");
    EXPECT_EQ(text("low.off twice.off", "1 pair of bodies (1 overlapping), 2 of 2 bodies, ").find("itself"),
              std::string::npos);
    const std::string both = text("high.off twice.off --self-overlaps",
                                  "1 pair of bodies (1 overlapping), 1 body overlaps itself, 2 of 2 bodies, ");
    EXPECT_TRUE(contains(both, "twice overlaps itself: volume 0.125\n")) << both;
    EXPECT_EQ(crumple("overlap twice.off --check").status, 1);
    EXPECT_EQ(crumple("overlap low.off --check").status, 0);
    for (const std::string name : {"a.csv", "a.json", "a.npz"}) {
        ASSERT_EQ(crumple("overlap twice.off high.off --self-overlaps -o " + name).status, 0);
        EXPECT_EQ(crumple("verify --overlaps twice.off high.off --self-overlaps " + name).out,
                  "right: 2 overlaps, 0 missed, 0 false, 0 of another relation, 0 of other numbers, 0 repeated\n");
    }
    EXPECT_EQ(crumple("verify --overlaps twice.off high.off a.csv").status, 1);
}

TEST_F(Overlap, error_in_a_list_names_the_place) {
    const auto expect_error = [&](const std::string& name, const std::string& bytes, const std::string& reason) {
        write(name, bytes);
        expect_refused("verify --overlaps low.off high.off " + name, name + reason);
    };
    expect_error("a.csv", heading + std::string("low,hihg,equal\n"), ", line 2: there is no body 'hihg'");
    expect_error("a.csv", "low,high,near\n", ", line 1: 'near' is not a relation of two bodies");
    expect_error("a.csv", "low,high,equal,1\n", ", line 1: after its relation a row must have all 18 numbers, or none");
    expect_error("a.csv", "low,high,equal\n" + std::string(low_high),
                 ", line 2: some rows have numbers and some do not");
    expect_error("a.csv", "low\n", ", line 1: the row has 1 columns instead of 21");
    expect_error("a.csv", "\"low,high,equal\n", ", line 1: a quote is not closed");
    expect_error("a.json", "{}", ": there is no array \"bodies\"");
    expect_error("a.json", R"({"bodies": [[0, 2]], "relation": [1]})", ": row 0 of \"bodies\": there is no such body");
    expect_error("a.json", R"({"bodies": [[0, 1]], "relation": [6]})",
                 ": row 0 of \"relation\": this is not a relation of two bodies");
    expect_error("a.json", R"({"bodies": [[0, 1]], "relation": [1, 1]})",
                 ": \"relation\" is not as long as \"bodies\"");
    expect_error("a.json", R"({"bodies": [[0, 1]], "relation": [1], "volume": [1]})",
                 ": there is no array \"centroid\"");
}

TEST_F(Overlap, coloured_formats_are_written_and_ply_holds_only_the_overlap) {
    const std::string outputs = " -o a.html -o a.glb -o a.3mf -o a.obj -o a.ply -o a.csv";
    const Outcome outcome = crumple("overlap low.off high.off far.off" + outputs);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("1 pair of bodies (1 overlapping), 2 of 3 bodies, ")) << outcome.err;
    EXPECT_TRUE(contains(read("a.csv"), "\nlow,high,overlapping,0.25,"));
    EXPECT_TRUE(contains(read("a.html"), "1 overlap of 3 bodies"));
    EXPECT_TRUE(contains(read("a.obj"), "mtllib a.mtl\n"));
    EXPECT_TRUE(contains(crumple("info a.ply").out, "box                   0 0 0.75 to 1 1 1\n"));
    EXPECT_TRUE(contains(crumple("info a.3mf").out, "\nbody 2                far\n"));
    EXPECT_EQ(shell("$crumple overlap low.off high.off far.off -o - --format glb > b.glb").status, 0);
    EXPECT_EQ(read("b.glb"), read("a.glb"));
    EXPECT_EQ(crumple("overlap low.off high.off --body-pairs --check -o c.ply").status, 1);
    EXPECT_TRUE(contains(crumple("info c.ply").out, "box                   0 0 0.75 to 1 1 1\n"));
}

TEST_F(Overlap, coloured_ply_is_empty_and_glb_complete_if_nothing_overlaps) {
    EXPECT_EQ(crumple("overlap low.off far.off -o a.ply -o a.glb").status, 0);
    EXPECT_TRUE(contains(crumple("info a.ply").out, "triangles             0\n"));
    EXPECT_TRUE(contains(crumple("info a.glb").out, "triangles             24\n"));
}

TEST_F(Overlap, wrong_options_are_refused) {
    expect_refused("overlap low.off high.off --open close", "close is not one of error|skip");
    expect_refused("overlap low.off high.off --groups bodies", "--groups");
    expect_refused("overlap low.off high.off --any-by-world", "--any-by-world needs --poses");
    expect_refused("overlap low.off high.off --excluded-bodies low,hihg", "there is no body hihg; did you mean high?");
    expect_refused("overlap low.off high.off -o a.stl",
                   "overlaps are written as .txt, .csv, .json or .npz, coloured as .html, .glb, .3mf, .obj, .ply");
    expect_refused("overlap low.off high.off -o - --format obj", "a coloured .obj needs a file beside it");
    expect_refused("overlap low.off high.off --poses p.csv -o a.glb", "with --poses, rows are written");
    expect_refused("overlap low.off high.off -o low.off", "overlaps are written as");
    expect_refused("overlap low.off high.off -o -", "-o - needs --format");
    expect_refused("overlap low.off high.off --poses p.csv --any-by-world -o a.npz",
                   "with --any-by-world, rows are written as .txt, .csv or .json");
    expect_refused("overlap low.off high.off --poses p.csv --any-by-world --body-pairs", "excludes");
    expect_refused("overlap low.off high.off --regions -o a.csv",
                   "regions, depths and withdrawals are written as .txt, .json or .npz");
    expect_refused("overlap low.off high.off --regions --body-pairs", "need all numbers of a row");
    expect_refused("overlap low.off high.off --depth-tolerance -1", "--depth-tolerance");
    expect_refused("overlap low.off high.off --depth-tolerance 0", "--depth-tolerance must be above 0");
    for (const char* const direction : {"0,0", "0,0,1,", "a,b,c", "0,0,nan", "0 0 1"})
        expect_refused(std::string("overlap low.off high.off --withdraw \"") + direction + '"',
                       "a direction is written as 0,0,1");
    expect_refused("overlap low.off high.off --withdraw 0,0,0", "the direction must not be 0");
    expect_refused("overlap low.off high.off --first-free", "--first-free needs --withdraw");
    expect_refused("overlap - -", "standard input, -, can be read only once");
    write("list.csv", heading);
    expect_refused("verify low.off high.off list.csv --min-volume 1", "--min-volume needs --overlaps");
    expect_refused("verify low.off high.off list.csv --open skip", "--open needs --overlaps");
    expect_refused("verify low.off high.off on.off list.csv", "or any number of files with --overlaps");
    expect_refused("verify --overlaps --radius 1 low.off high.off list.csv", "exclude each other");
    expect_refused("verify --overlaps low.off high.off list.csv --kind proper", "--kind does not go with --overlaps");
    EXPECT_TRUE(contains(crumple("detect --help").out, "crumple overlap does"));
}

}  // namespace
}  // namespace crumple::cli::test
