// Tests of crumple check on boxes, and on a part that passes through itself.

#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "off_boxes.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

using Json = nlohmann::json;

struct TestBox {
    Corner low, high;
    bool faces_inwards = false;
    std::size_t triangles = 12;
};

/// Returns boxes as the shells of one body in OFF.
std::string shells_off(const std::vector<TestBox>& boxes) {
    std::ostringstream points, faces;
    std::size_t first = 0, triangles = 0;
    for (const TestBox& box : boxes) {
        for (const auto& [x, y, z] : box_corners(box.low, box.high)) points << x << ' ' << y << ' ' << z << '\n';
        for (std::size_t t = 0; t < box.triangles; ++t, ++triangles) {
            auto [a, b, c] = box_triangles[t];
            if (box.faces_inwards) std::swap(b, c);
            faces << "3 " << first + static_cast<std::size_t>(a) << ' ' << first + static_cast<std::size_t>(b) << ' '
                  << first + static_cast<std::size_t>(c) << '\n';
        }
        first += 8;
    }
    return "OFF\n" + std::to_string(first) + ' ' + std::to_string(triangles) + " 0\n" + points.str() + faces.str();
}

/// Returns two boxes as one shell in OFF: a tetrahedron beside them has a vertex in common with each.
std::string bridged_off(const Corner& low, const Corner& high, const Corner& other_low, const Corner& other_high) {
    std::ostringstream out;
    out << "OFF\n18 28 0\n";
    for (const auto& corners : {box_corners(low, high), box_corners(other_low, other_high)})
        for (const auto& [x, y, z] : corners) out << x << ' ' << y << ' ' << z << '\n';
    const auto& [x, y, z] = high;
    out << x + 2 << ' ' << y + 2 << ' ' << z << '\n' << x + 2 << ' ' << y + 0.25 << ' ' << z + 1 << '\n';
    for (const int first : {0, 8})
        for (const auto& [a, b, c] : box_triangles)
            out << "3 " << first + a << ' ' << first + b << ' ' << first + c << '\n';
    out << "3 7 15 16\n3 7 17 15\n3 7 16 17\n3 15 17 16\n";
    return out.str();
}

class Check : public Cli {
   protected:
    Check() {
        write("low.off", box_off({0, 0, 0}, {1, 1, 1}));
        write("high.off", box_off({0, 0, 0.75}, {1, 1, 1.75}));
        write("on.off", box_off({0, 0, 1}, {1, 1, 2}));
        write("far.off", box_off({0, 0, 1.0625}, {1, 1, 2}));
        write("flush.off", box_off({0.25, 0.25, 0.9921875}, {0.75, 0.75, 2}));
        write("small.off", box_off({0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}));
        write("rod.off", box_off({0.25, 0.25, -1}, {0.5, 0.5, 3}));
        write("open.off", box_off({0, 0, 0.75}, {1, 1, 1.75}, 10));
    }
    Outcome check(const std::string& arguments) const { return crumple("check " + arguments); }
    /// Expects this text on standard output, nothing on standard error, and this status.
    void expect(const std::string& arguments, int status, const std::string& text) const {
        const Outcome outcome = check(arguments);
        EXPECT_EQ(outcome.status, status) << arguments;
        EXPECT_EQ(outcome.out, text) << arguments;
        EXPECT_EQ(outcome.err, "") << arguments;
    }
    /// Expects `text` somewhere in the output of a check that has findings.
    void expect_finding(const std::string& arguments, const std::string& text) const {
        const Outcome outcome = check(arguments);
        EXPECT_EQ(outcome.status, 1) << arguments;
        EXPECT_TRUE(contains(outcome.out, text)) << arguments << ": " << outcome.out << outcome.err;
    }
    void expect_refused(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = check(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
    }
    Json json(const std::string& arguments) const { return Json::parse(check(arguments + " --json").out); }
};

TEST_F(Check, only_edges_with_an_odd_number_of_triangles_are_non_manifold_findings) {
    // A tetrahedron and another one that lacks a face share edge 01; then a third triangle is added to edge 12.
    const std::string points = "OFF\n7 NN 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 -1 0\n0 0 -1\n2 2 2\n";
    const std::string faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 0 1 4\n3 1 0 5\n3 0 4 5\n";
    const auto with = [](std::string text, const std::string& count) {
        return text.replace(text.find("NN"), 2, count);
    };
    write("four.off", with(points, "7") + faces);
    write("three.off", with(points, "8") + faces + "3 1 2 6\n");
    EXPECT_FALSE(contains(check("four.off").out, "non-manifold"));
    expect_finding("three.off", "three is not closed: it has 1 non-manifold edge");
}

TEST_F(Check, sound_body_has_no_findings) {
    expect("low.off --unit mm", 0, "low: closed, volume 1 mm^3, 12 triangles\nno findings\n");
}

TEST_F(Check, holes_are_listed_with_centre_and_length) {
    write("box.off", box_off({0, 0, 0}, {2, 2, 2}, 11));
    expect("box.off", 1,
           "box: not closed, 1 hole, 11 triangles\n"
           "  box has a hole around (0.707107 1.29289 2): 3 edges, length 6.82843\n"
           "1 finding\n");
    const Json found = json("box.off");
    EXPECT_EQ(found["bodies"][0]["boundary_loops"].size(), 1u);
    EXPECT_EQ(found["bodies"][0]["boundary_loops"][0]["edges"], 3);
    EXPECT_EQ(found["bodies"][0]["volume"], Json());
    EXPECT_EQ(found["items"][0]["kind"], "hole");
    EXPECT_EQ(found["items"][0]["box"]["low"], (Corner{0, 0, 2}));
    write("two.off", shells_off({{{0, 0, 0}, {1, 1, 1}, false, 10}, {{5, 5, 5}, {6, 6, 6}, false, 10}}));
    EXPECT_EQ(json("two.off")["bodies"][0]["boundary_loops"].size(), 2u);
}

TEST_F(Check, irregular_triangles_are_listed) {
    std::string off = box_off({0, 0, 0}, {1, 1, 1}, 11);
    off.replace(off.find("11 0"), 4, "12 0");
    write("flipped.off", off + "3 1 3 7\n");
    expect_finding("flipped.off", "flipped is not consistently oriented: triangles ");
    off.replace(off.find("12 0"), 4, "14 0");
    write("twice.off", off + "3 1 7 3\n3 1 7 3\n3 1 3 3\n");
    expect_finding("twice.off", "  twice has 1 degenerate triangle (13)\n  twice has 1 duplicated triangle (12)\n");
    write("empty.off", "OFF\n0 0 0\n");
    expect_finding("empty.off", "empty: empty, 0 triangles\n  empty has no triangles\n");
}

TEST_F(Check, shells_that_are_inside_out_or_nested_are_findings_and_cavities_are_not) {
    write("out.off", shells_off({{{0, 0, 0}, {1, 1, 1}, true}}));
    expect("out.off", 1,
           "out: closed, inside out, volume -1, 12 triangles\n  out is inside out: volume -1\n1 finding\n");
    const TestBox outer{{0, 0, 0}, {4, 4, 4}}, cavity{{1, 1, 1}, {3, 3, 3}, true}, ball{{1.5, 1.5, 1.5}, {2, 2, 2}};
    write("hollow.off", shells_off({outer, cavity, ball}));
    expect("hollow.off", 0,
           "hollow: closed, volume 56.125, 36 triangles, 3 shells (1 of them a cavity)\nno findings\n");
    write("nested.off", shells_off({outer, ball}));
    expect_finding("nested.off", "  shell 1 of nested lies inside shell 0 of nested: volume 0.125, ");
    write("wrong.off", shells_off({outer, cavity, {{1.5, 1.5, 1.5}, {2, 2, 2}, true}}));
    expect_finding("wrong.off", "  shell 2 of wrong is inside out: volume -0.125\n");
    write("apart.off", shells_off({outer, {{5, 5, 5}, {6, 6, 6}, true}}));
    expect_finding("apart.off", "  shell 1 of apart is inside out: volume -1\n");
    EXPECT_EQ(json("hollow.off")["bodies"][0]["shells"][1]["cavity"], true);
    EXPECT_EQ(json("hollow.off")["bodies"][0]["shells"][2]["inside"], (std::vector<int>{0, 1}));
}

TEST_F(Check, shells_that_overlap_are_findings_though_another_shell_is_open) {
    const TestBox first{{0, 0, 0}, {2, 2, 2}}, second{{1, 1, 1}, {3, 3, 3}}, open{{8, 8, 8}, {9, 9, 9}, false, 10};
    write("part.off", shells_off({first, second, open}));
    const Outcome outcome = check("part.off");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(contains(outcome.out, "part: not closed, 1 hole, 34 triangles, 3 shells\n  part has a hole "))
        << outcome.out;
    EXPECT_TRUE(contains(outcome.out,
                         "  shells 0 and 1 of part overlap: volume 1, mean depth 0.57735, "
                         "greatest depth at most 1, around (1.5 1.5 1.5)\n2 findings\n"))
        << outcome.out;
    write("touch.off", shells_off({first, {{2, 0, 0}, {3, 2, 2}}}));
    expect_finding("touch.off", "  shells 0 and 1 of touch touch: common area 4, around (2 1 1)\n");
}

TEST_F(Check, places_and_their_volume_agree_with_detect_and_overlap) {
    ASSERT_EQ(crumple("make model --triangles 4000 -o part.ply").status, 0);
    const Json found = json("part.ply");
    ASSERT_EQ(crumple("overlap part.ply -o overlap.json").status, 0);
    ASSERT_EQ(crumple("detect part.ply -o pairs.json").status, 0);
    const double volume = Json::parse(read("overlap.json"))["volume"][0];
    EXPECT_EQ(found["bodies"][0]["overlap_with_itself"], volume);
    std::set<int> hit;
    const Json pairs = Json::parse(read("pairs.json"));
    for (const Json& pair : pairs["pairs"])
        for (const int t : pair) hit.insert(t);
    std::size_t triangles = 0, last = std::numeric_limits<std::size_t>::max();
    ASSERT_GT(found["items"].size(), 0u);
    for (const Json& item : found["items"]) {
        EXPECT_EQ(item["kind"], "self_intersection");
        EXPECT_LE(item["count"], last) << "the largest places are first";
        last = item["count"];
        triangles += last;
    }
    EXPECT_GE(triangles, hit.size());
    EXPECT_LE(found["items"][0]["count"], hit.size());
}

TEST_F(Check, depth_of_a_shell_in_itself_is_that_of_the_bodies_that_it_consists_of) {
    const Corner low{0.25, 0.25, 0.75}, high{0.75, 0.75, 2};
    write("one.off", bridged_off({0, 0, 0}, {1, 1, 1}, low, high));
    write("pin.off", box_off(low, high));
    const Json found = json("one.off --unit mm"), item = found["items"][0], pair = json("low.off pin.off")["items"][0];
    ASSERT_EQ(found["items"].size(), 1u) << found;
    EXPECT_EQ(item["kind"], "self_intersection");
    EXPECT_EQ(item["volume"], pair["volume"]);
    EXPECT_NEAR(item["depth_reached"], 0.25, 0.0025);
    EXPECT_LE(item["depth_reached"], 0.25);
    EXPECT_GE(item["depth_bound"], 0.25);
    EXPECT_NEAR(item["depth_bound"], pair["depth_bound"], 0.005);
    expect_finding("one.off --unit mm", ": 10 triangles, overlap 0.0625 mm^3, greatest depth at most 0.25");
}

TEST_F(Check, faces_in_a_common_plane_do_not_hide_the_depth_of_a_shell_in_itself) {
    write("one.off", bridged_off({0, 0, 0}, {1, 1, 1}, {0, 0, 0.75}, {1, 1, 2}));
    const Json item = json("one.off")["items"][0];
    EXPECT_EQ(item["volume"], 0.25);
    EXPECT_NEAR(item["depth_reached"], 0.25, 0.0025);
    EXPECT_NEAR(item["depth_bound"], 0.25, 0.0025);
}

TEST_F(Check, rod_through_a_plate_of_one_shell_is_one_place) {
    write("one.off", bridged_off({0, 0, 0}, {4, 4, 1}, {1, 1, -1}, {2, 2, 2}));
    const Json found = json("one.off");
    ASSERT_EQ(found["items"].size(), 1u) << found;
    const Json item = found["items"][0];
    EXPECT_EQ(item["volume"], 1);
    EXPECT_EQ(item["centre"], (Corner{1.5, 1.5, 0.5}));
    EXPECT_NEAR(item["depth_reached"], 0.5, 0.005);
    EXPECT_GE(item["depth_bound"], 0.5);
}

TEST_F(Check, every_overlap_of_a_shell_with_itself_has_a_volume_and_a_depth) {
    ASSERT_EQ(crumple("make model --triangles 4000 -o part.ply").status, 0);
    const Json found = json("part.ply");
    double volume = 0;
    for (const Json& item : found["items"]) {
        volume += double{item["volume"]};
        EXPECT_GT(item["depth_reached"], 0);
        EXPECT_GE(item["depth_bound"], item["depth_reached"]);
    }
    EXPECT_NEAR(volume, found["bodies"][0]["overlap_with_itself"], 1e-9 * volume);
}

/// Makes a strip that passes through the two legs of a body: one shell, two places.
TEST_F(Check, places_are_connected_groups_of_triangles) {
    write("legs.off", shells_off({{{0, 0, 0}, {1, 1, 1}}, {{3, 0, 0}, {4, 1, 1}}}));
    write("sheet.off", "OFF\n4 2 0\n-1 -1 0.5\n5 -1 0.5\n5 2 0.5\n-1 2 0.5\n3 0 1 2\n3 0 2 3\n");
    const Json pair = json("legs.off sheet.off")["items"].back();
    EXPECT_EQ(pair["kind"], "undefined");
    ASSERT_EQ(pair["places"].size(), 2u);
    EXPECT_EQ(pair["places"][0]["centre"], (Corner{0.5, 0.5, 0.5}));
    EXPECT_EQ(pair["places"][1]["centre"], (Corner{3.5, 0.5, 0.5}));
}

TEST_F(Check, relations_of_bodies_are_listed_with_numbers) {
    const std::string low = "low: closed, volume 1, 12 triangles\n";
    expect("low.off high.off", 1,
           low +
               "high: closed, volume 1, 12 triangles\n"
               "low and high overlap: volume 0.25, mean depth 0.25, greatest depth at most 0.250975, common area 1, "
               "around (0.5 0.5 0.875)\n1 finding\n");
    expect(
        "low.off on.off", 0,
        low + "on: closed, volume 1, 12 triangles\nlow and on touch: common area 1, around (0.5 0.5 1)\nno findings\n");
    expect_finding("small.off low.off", "\nsmall lies inside low: volume 0.015625, ");
    expect_finding("low.off small.off", "\nsmall lies inside low: volume 0.015625, ");
    expect_finding("low.off low.off", "\nlow and low_2 have the same triangles: volume 1, ");
    expect_finding("open.off open.off", "\nopen and open_2 have the same triangles: ");
    EXPECT_EQ(json("low.off high.off")["items"][0]["places"].size(), 1u);
}

TEST_F(Check, body_that_passes_through_another_one_is_piercing) {
    expect_finding("low.off rod.off", "\nrod passes through low: volume 0.0625, ");
    expect_finding("rod.off low.off", "\nrod passes through low: volume 0.0625, ");
    EXPECT_EQ(json("low.off rod.off")["items"][0]["kind"], "piercing");
    EXPECT_EQ(json("low.off rod.off")["items"][0]["places"][0]["pieces"], (std::vector<int>{2, 1}));
    EXPECT_EQ(json("high.off rod.off flush.off")["items"][0]["kind"], "piercing");
    EXPECT_EQ(json("low.off flush.off")["items"][0]["kind"], "overlapping");
}

TEST_F(Check, shallow_overlaps_are_ignored_on_request) {
    expect_finding("low.off flush.off", "\nlow and flush overlap: ");
    expect_finding("low.off flush.off --ignore-below 0.0078", "\nlow and flush overlap: ");
    const Outcome ignored = check("low.off flush.off --ignore-below 0.01");
    EXPECT_EQ(ignored.status, 0);
    EXPECT_TRUE(contains(ignored.out, ", ignored\nno findings\n")) << ignored.out;
    EXPECT_EQ(check("low.off flush.off --unit mm --ignore-below 0.001cm").status, 0);
    expect_finding("low.off flush.off --unit mm --ignore-below 1um", "\nlow and flush overlap: ");
    expect_finding("low.off high.off --ignore-below 0.01", "\nlow and high overlap: ");
}

TEST_F(Check, pairs_nearer_than_the_clearance_are_findings) {
    EXPECT_EQ(check("low.off far.off").status, 0);
    EXPECT_EQ(check("low.off far.off --clearance 0.0625").status, 0) << "not nearer";
    expect_finding("low.off far.off --clearance 0.0626",
                   "\nlow and far are near each other: clearance 0.0625, around ");
    expect_finding("low.off far.off --unit cm --clearance '1 mm'", ": clearance 0.0625 cm, ");
    EXPECT_EQ(check("low.off far.off --unit cm --clearance 0.6mm").status, 0);
    expect_finding("low.off on.off --clearance 0.1", "\nlow and on touch: common area 1, clearance 0, ");
    EXPECT_EQ(check("low.off on.off --clearance 0.1 --ignore-below 0.01").status, 0) << "flush";
    expect_finding("low.off far.off --clearance 0.1 --ignore-below 0.01", ": clearance 0.0625, ");
    expect_finding("low.off small.off --clearance 0.5", "\nsmall lies inside low: volume 0.015625, ");
    const Json near = json("low.off far.off --clearance 1")["items"][0];
    EXPECT_EQ(near["clearance"], 0.0625);
    EXPECT_EQ(near["closest_points"][0][2], 1);
    EXPECT_EQ(near["closest_points"][1][2], 1.0625);
}

TEST_F(Check, open_bodies_are_reported_and_do_not_stop_the_check) {
    expect("low.off open.off on.off", 1,
           "low: closed, volume 1, 12 triangles\n"
           "open: not closed, 1 hole, 10 triangles\n"
           "  open has a hole around (0.5 0.5 1.75): 4 edges, length 4\n"
           "on: closed, volume 1, 12 triangles\n"
           "the surfaces of low and open meet, and at least one is not closed: around (0.5 0.5 0.875)\n"
           "low and on touch: common area 1, around (0.5 0.5 1)\n"
           "the surfaces of open and on meet, and at least one is not closed: around (0.5 0.5 1.375)\n"
           "3 findings\n");
}

TEST_F(Check, excluded_bodies_are_not_paired) {
    EXPECT_EQ(check("low.off high.off --excluded-bodies low,high").status, 0);
    EXPECT_EQ(check("low.off low.off --excluded-bodies low_2,low").status, 0);
    EXPECT_EQ(check("low.off far.off --clearance 1 --excluded-bodies far,low").status, 0);
    expect_refused("low.off high.off --excluded-bodies low,hihg", "did you mean high?");
}

TEST_F(Check, csv_and_json_files_hold_all_items) {
    const Outcome outcome = check("low.off high.off rod.off --unit in -o a.csv -o a.json -o a.txt");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "3 findings\n");
    const std::string csv = read("a.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
    EXPECT_TRUE(csv.starts_with("kind,finding,first,first_shell,second,second_shell,x,y,z,low_x,")) << csv;
    EXPECT_TRUE(contains(csv, "\noverlapping,1,low,,high,,0.5,0.5,0.875,0,0,0.75,1,1,1,")) << csv;
    EXPECT_TRUE(contains(csv, "\npiercing,1,low,,rod,,")) << csv;
    const Json found = Json::parse(read("a.json"));
    EXPECT_EQ(found["unit"], "in");
    EXPECT_EQ(found["findings"], 3);
    EXPECT_EQ(found["items"].size(), 3u);
    EXPECT_EQ(found["items"][0]["volume"], 0.25);
    EXPECT_TRUE(contains(read("a.txt"), "volume 0.25 in^3, "));
    EXPECT_EQ(check("low.off high.off rod.off --unit in -o - --format csv").out, csv);
}

/// Returns the data of a page.
Json data_of(const std::string& page) {
    const std::string begin = "const data = ";
    const std::size_t at = page.find(begin) + begin.size();
    return Json::parse(page.substr(at, page.find(";\n", at) - at));
}
/// Returns the number of bytes of an array that is encoded in base64.
std::size_t bytes_of(const Json& data, const char* name) {
    const std::string text = data[name];
    return text.size() / 4 * 3 - static_cast<std::size_t>(std::count(text.begin(), text.end(), '='));
}

TEST_F(Check, page_lists_places_and_colours_triangles_near_them) {
    write("a<b>.off", box_off({0.25, 0.25, -1}, {0.5, 0.5, 3}));
    write("apart.off", box_off({5, 5, 5}, {6, 6, 6}));
    const Outcome outcome = check("low.off 'a<b>.off' apart.off --unit mm -o report.html");
    ASSERT_EQ(outcome.status, 1) << outcome.err;
    const std::string page = read("report.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_FALSE(contains(page, "a<b>")) << "a name must not end the script";
    EXPECT_FALSE(contains(page, "http"));
    const Json data = data_of(page), report = data["report"];
    EXPECT_EQ(report["title"], "low.off, a<b>.off, apart.off");
    EXPECT_EQ(report["summary"], "1 finding");
    EXPECT_EQ(data["unit"], "mm");
    EXPECT_EQ(bytes_of(data, "vertices"), 3 * 8 * 3 * sizeof(float));
    EXPECT_EQ(bytes_of(data, "triangles"), 3 * 12 * 3 * 4u);
    ASSERT_EQ(report["bodies"].size(), 3u);
    EXPECT_EQ(report["bodies"][1]["corners"], (std::vector<int>{36, 36}));
    EXPECT_EQ(report["bodies"][1]["finding"], true);
    EXPECT_EQ(report["bodies"][2]["finding"], false);
    ASSERT_EQ(report["items"].size(), 1u);
    EXPECT_EQ(report["items"][0]["bodies"], (std::vector<int>{0, 1}));
    EXPECT_EQ(report["items"][0]["box"].size(), 2u);
    ASSERT_EQ(report["drawings"].size(), 1u);
    EXPECT_EQ(report["drawings"][0]["bodies"], (std::vector<int>{0, 1}));
    const std::size_t contacts = report["drawings"][0]["contacts"][1];
    EXPECT_GE(contacts, 8u);
    EXPECT_EQ(bytes_of(data, "contact_triangles"), 8 * contacts);
    EXPECT_EQ(bytes_of(data, "contact_segments"), 24 * contacts);
    EXPECT_EQ(check("far.off -o none.html").status, 0);
    EXPECT_EQ(data_of(read("none.html"))["report"]["items"].size(), 0u);
}

TEST_F(Check, page_shows_holes_common_faces_and_every_place_of_a_pair) {
    write("legs.off", shells_off({{{0, 0, 0}, {1, 1, 1}}, {{3, 0, 0}, {4, 1, 1}}}));
    write("bar.off", box_off({-1, 0.25, 0.75}, {5, 0.5, 2}));
    ASSERT_EQ(check("legs.off bar.off open.off low.off on.off -o a.html --clearance 0.1").status, 1);
    const Json data = data_of(read("a.html")), items = data["report"]["items"];
    const auto has = [&](const std::string& text) {
        return std::any_of(items.begin(), items.end(), [&](const Json& item) { return contains(item["text"], text); });
    };
    EXPECT_TRUE(has("open has a hole around "));
    EXPECT_TRUE(has("legs and bar overlap: volume 0.125") || has("bar passes through legs: volume 0.125"));
    EXPECT_TRUE(has("place 0 around (0.5 0.375 0.875): volume 0.0625"));
    EXPECT_TRUE(has("place 1 around (3.5 0.375 0.875): volume 0.0625"));
    EXPECT_TRUE(has("low and on touch"));
    EXPECT_GT(bytes_of(data, "drawn_areas"), 0u) << "the common face of low and on";
}

TEST_F(Check, many_places_are_counted_in_text_and_listed_in_files) {
    std::string faces, points;
    for (int i = 0; i < 12; ++i) {
        points += "\n" + std::to_string(4 * i) + " 0 0\n" + std::to_string(4 * i + 1) + " 0 0\n" +
                  std::to_string(4 * i) + " 1 0";
        faces += "\n3 " + std::to_string(3 * i) + ' ' + std::to_string(3 * i + 1) + ' ' + std::to_string(3 * i + 2);
    }
    write("many.off", "OFF\n36 12 0" + points + faces + '\n');
    const Outcome outcome = check("many.off -o many.csv");
    EXPECT_TRUE(contains(check("many.off").out,
                         "  many: 2 more items of the kind hole; .csv and .json files list them all (-o)\n12 find"));
    const std::string csv = read("many.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "many: most faces share no vertices, so that each is a shell; --weld "));
}

TEST_F(Check, no_output_is_replaced_if_another_one_cannot_be_written) {
    for (const std::string command : {"check low.off high.off", "detect low.off high.off", "overlap low.off high.off",
                                      "near low.off high.off --radius 1"}) {
        write("old.csv", "old");
        const Outcome outcome = crumple(command + " -o old.csv -o nowhere/new.csv");
        EXPECT_EQ(outcome.status, 2) << command;
        EXPECT_TRUE(contains(outcome.err, "nowhere")) << outcome.err;
        EXPECT_EQ(read("old.csv"), "old") << command;
    }
}

TEST_F(Check, wrong_use_is_refused) {
    expect_refused("none.off", "none.off");
    expect_refused("low.off --clearance 0.1mm", "--clearance 0.1mm: the files state no unit; state it by --unit");
    for (const char* const length : {"x", "-1", "0.1parsec", "nan", "mm", "1e999"})
        expect_refused("low.off --clearance=" + std::string(length), "is not a length, such as 0.1mm");
    expect_refused("low.off --ignore-below 1furlong", "--ignore-below: 1furlong is not a length");
    expect_refused("low.off -o a.png", "-o a.png: a check is written as .txt, .csv, .json or .html");
    expect_refused("low.off --json -o - --format csv", "--json does not go with -o -");
    expect_refused("low.off -o low.off", "-o low.off: a check is written as");
    expect_refused("", "FILE");
}

}  // namespace
}  // namespace crumple::cli::test
