#include <array>
#include <random>
#include <set>

#include <nlohmann/json.hpp>

#include "run.h"

namespace crumple::cli::test {
namespace {

using Info = Cli;

TEST_F(Info, counts_and_properties_of_a_mesh_are_printed) {
    write("five.off", five_off);
    const Outcome outcome = crumple("info five.off");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out,
              "unit                  unknown\n"
              "vertices              14 (1 unused)\n"
              "triangles             5\n"
              "precision             float64\n"
              "box                   -1 -1 -1 to 14 7 7\n"
              "degenerate triangles  0\n"
              "duplicated triangles  0\n"
              "open edges            13\n"
              "  the first           0-1, from (0 0 0) to (4 0 0)\n"
              "                      0-2, from (0 0 0) to (0 4 0)\n"
              "                      1-2, from (4 0 0) to (0 4 0)\n"
              "holes                 4\n"
              "non-manifold edges    0\n"
              "orientation           not consistent\n"
              "  the first           triangles 2 and 4 run along edge 6-7, from (10 0 0) to (14 0 0), in the same "
              "direction\n"
              "connected components  4\n"
              "closed                no\n"
              "volume                none: the surface is not closed, or not consistently oriented\n");
}

/// Returns a cube in OFF whose triangles are anticlockwise from outside. The last of the twelve is given by the caller.
std::string cube_with(const std::string& last_triangle) {
    return "OFF\n8 12 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n3 0 2 1\n3 1 2 3\n3 4 5 6\n"
           "3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n" +
           last_triangle + "\n";
}

TEST_F(Info, check_fails_for_open_inconsistently_oriented_inside_out_or_empty_meshes) {
    const auto info = [&](const std::string& off, const std::string& options = "") {
        write("a.off", off);
        return crumple("info a.off --check " + options);
    };
    const std::string good = cube_with("3 3 7 5");
    EXPECT_EQ(info(good).status, 0);
    EXPECT_TRUE(contains(info(good).out, "orientation           consistent\n"));
    EXPECT_TRUE(contains(info(good).out, "closed                yes\nvolume                1\n"));
    EXPECT_TRUE(contains(info(good, "--unit in").out, "volume                1 in^3\n"));

    const Outcome flipped = info(cube_with("3 3 5 7"));
    EXPECT_EQ(flipped.status, 1);
    EXPECT_TRUE(contains(flipped.out, "triangles 10 and 11 run along edge 3-5, from (1 1 0) to (1 0 1), in the same"));
    EXPECT_TRUE(contains(flipped.out, "closed                yes\nvolume                none"));

    const Outcome open = info(cube_with("2 0 1"));
    EXPECT_EQ(open.status, 1);
    EXPECT_TRUE(contains(open.out, "open edges            3\n  the first           3-5, from (1 1 0) to (1 0 1)\n"));
    EXPECT_TRUE(contains(open.out, "holes                 1\n"));

    std::string inside_out = good;  // mirrored along x
    for (const auto& [from, to] : {std::pair("\n1 ", "\n-1 ")})
        for (std::size_t at = 0; (at = inside_out.find(from, at)) != inside_out.npos; at += 3)
            inside_out.replace(at, 3, to);
    EXPECT_TRUE(contains(info(inside_out).out, "volume                -1: the surface is inside out\n"));
    EXPECT_EQ(info(inside_out).status, 1);
    EXPECT_TRUE(contains(info(inside_out, "--json").out, "\"inside_out\": true"));
    EXPECT_EQ(info("OFF\n0 0 0\n").status, 1) << "nothing is no solid";

    const auto scaled = [&](const std::string& power) {
        std::string large = good;
        for (std::size_t at = large.find("\n0 0 0"); (at = large.find('1', at)) < large.find("\n3 "); at += 4)
            large.insert(at + 1, power);
        return large;
    };
    EXPECT_TRUE(contains(info(scaled("e99")).out, "volume                1e+297\n"));
    EXPECT_TRUE(contains(info(scaled("e-99")).out, "volume                1e-297\n"));
    EXPECT_TRUE(contains(info(scaled("e200")).out, "volume                inf\n"));
}

TEST_F(Info, open_edges_option_lists_all_open_edges) {
    write("closed.off", cube_with("3 3 7 5"));
    EXPECT_TRUE(contains(crumple("info closed.off --open-edges").out, "\nlist of open edges    0\nholes "));
    write("a.off", cube_with("3 3 5 7"));  // the last one is flipped
    EXPECT_TRUE(contains(crumple("info a.off --open-edges").out,
                         "open edges            0\n"
                         "list of open edges    3\n"
                         "                      3-5, from (1 1 0) to (1 0 1), of triangle 10\n"
                         "                      3-7, from (1 1 0) to (1 1 1), of triangle 7\n"
                         "                      5-7, from (1 0 1) to (1 1 1), of triangle 3\n"
                         "holes "))
        << crumple("info a.off --open-edges").out;
    const auto json = nlohmann::json::parse(crumple("info a.off --open-edges --json").out)["bodies"][0];
    ASSERT_EQ(json["list_of_open_edges"].size(), 3u);
    EXPECT_EQ(json["list_of_open_edges"][1].dump(),
              R"({"points":[[1.0,1.0,0.0],[1.0,1.0,1.0]],"triangle":7,"vertices":[3,7]})");
    EXPECT_FALSE(nlohmann::json::parse(crumple("info a.off --json").out)["bodies"][0].contains("list_of_open_edges"));
    EXPECT_EQ(crumple("info a.off --open-edges --check").status, 1);
    write("open.off", cube_with("2 0 1"));  // without the last one
    EXPECT_TRUE(contains(crumple("info open.off --open-edges").out,
                         "\nlist of open edges    3\n"
                         "                      3-5, from (1 1 0) to (1 0 1), of triangle 10\n"
                         "                      3-7, from (1 1 0) to (1 1 1), of triangle 7\n"
                         "                      5-7, from (1 0 1) to (1 1 1), of triangle 3\n"
                         "holes                 1\n"))
        << crumple("info open.off --open-edges").out;
}

TEST_F(Info, json_has_the_properties_of_a_body) {
    write("a.off", cube_with("3 3 7 5"));
    const auto json = nlohmann::json::parse(crumple("info a.off --json --unit mm").out);
    EXPECT_EQ(json["file"], "a.off");
    EXPECT_EQ(json["unit"], "mm");
    const auto& body = json["bodies"][0];
    EXPECT_EQ(body["name"], "a");
    EXPECT_EQ(body["box"]["high"], (std::vector<double>{1, 1, 1}));
    EXPECT_EQ(body["volume"], 1);
    EXPECT_EQ(body["sound"], true);
    EXPECT_TRUE(body["first_flipped_edge"].is_null());
    write("b.off", cube_with("3 3 5 7"));
    const auto flipped = nlohmann::json::parse(crumple("info b.off --json").out);
    EXPECT_TRUE(flipped["unit"].is_null());
    EXPECT_EQ(flipped["bodies"][0]["first_flipped_edge"]["triangles"], (std::vector<int>{10, 11}));
    EXPECT_TRUE(flipped["bodies"][0]["volume"].is_null());
}

TEST_F(Info, weld_counts_equal_positions_once) {
    write("five.off", five_off);
    const std::string out = crumple("info five.off --weld --precision float32").out;
    EXPECT_TRUE(contains(out, "vertices              13 (1 unused)\n")) << out;
    EXPECT_TRUE(contains(out, "precision             float32\n")) << out;
    EXPECT_TRUE(contains(out, "connected components  3\n")) << out;
}

TEST_F(Info, degenerate_and_duplicated_triangles_are_listed) {
    // Vertices 5, 6 and 7 are exactly on one line, since each has three equal coordinates, although 0.3 is not exactly
    // three times 0.1 in float64.
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

TEST_F(Info, duplicates_are_those_of_brute_force_and_0_equals_minus_0) {
    const std::array<std::string, 4> coordinates{"0", "-0", "1", "2"};
    std::mt19937 random(7);
    const auto any_of_four = [&] { return random() % 4; };
    std::string off = "OFF\n6000 2000 0\n", faces;
    std::set<std::multiset<std::array<int, 3>>> seen;
    std::vector<int> expected;
    for (int t = 0; t < 2000; ++t) {
        std::multiset<std::array<int, 3>> corners;
        for (int corner = 0; corner < 3; ++corner) {
            std::array<int, 3> position{};
            for (int& x : position) {
                const std::string& text = coordinates[any_of_four()];
                off += text + ' ';
                x = std::stoi(text);
            }
            off += '\n';
            corners.insert(position);
        }
        faces +=
            "3 " + std::to_string(3 * t) + ' ' + std::to_string(3 * t + 1) + ' ' + std::to_string(3 * t + 2) + '\n';
        if (!seen.insert(corners).second) expected.push_back(t);
    }
    write("random.off", off + faces);
    EXPECT_GT(expected.size(), 100u);
    EXPECT_LT(expected.size(), 1900u);
    for (const std::string precision : {"float32", "float64"}) {
        const auto json = nlohmann::json::parse(crumple("info random.off --json --precision " + precision).out);
        EXPECT_EQ(json["bodies"][0]["duplicated_triangles"], expected);
    }
}

TEST_F(Info, degeneracy_is_decided_exactly) {
    // In float64, 0.3 is not exactly three times 0.1, so the points of almost.off are not on one line. Multiples by
    // powers of two are exact, so those of exactly.off are.
    write("almost.off", "OFF\n3 1 0\n1 0.1 0\n2 0.2 0\n3 0.3 0\n3 0 1 2\n");
    EXPECT_TRUE(contains(crumple("info almost.off").out, "degenerate triangles  0\n"));
    write("exactly.off", "OFF\n3 1 0\n1 1e-300 0\n2 2e-300 0\n4 4e-300 0\n3 0 1 2\n");
    EXPECT_TRUE(contains(crumple("info exactly.off").out, "degenerate triangles  1 (0)\n"));
}

TEST_F(Info, only_the_first_few_degenerate_triangles_are_shown) {
    std::string off = "OFF\n2 1234 0\n0 0 0\n1 0 0\n";
    for (int i = 0; i < 1234; ++i) off += "3 0 1 1\n";
    write("many.off", off);
    EXPECT_TRUE(contains(crumple("info many.off").out, "degenerate triangles  1,234 (0, 1, 2, 3, 4, ...)\n"));
}

TEST_F(Info, empty_mesh_is_no_error) {
    write("empty.off", "OFF\n0 0 0\n");
    const Outcome outcome = crumple("info empty.off");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(contains(outcome.out, "triangles             0\n")) << outcome.out << outcome.err;
}

TEST_F(Info, devices_option_needs_no_file_and_lists_devices_or_none) {
    const Outcome outcome = crumple("info --devices");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(outcome.out.starts_with("0  ") || outcome.out.starts_with("none: the cuda backend ")) << outcome.out;
}

}  // namespace
}  // namespace crumple::cli::test
