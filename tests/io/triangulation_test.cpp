// Tests of cutting polygons into triangles: a fan for convex polygons, no overlaps for concave ones, and a fan with a
// warning for polygons that cross themselves.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include "crumple/detector.h"
#include "files.h"
#include "geometry/predicates.h"
#include "rounds.h"

namespace crumple::io::test {
namespace {

using Point = std::array<double, 2>;
using Outline = std::vector<Point>;
using Indices = std::vector<std::int32_t>;

/// Returns an OBJ text with one polygon, whose corners are the vertices of the outline in the order of `corners`, or in
/// their own order if `corners` is empty.
std::string obj_of(const Outline& outline, Indices corners = {}, const std::array<int, 3>& axes = {0, 1, 2},
                   double scale = 1) {
    std::ostringstream text;
    text.precision(17);
    for (const Point& p : outline) {
        const std::array<double, 3> xyz{scale * p[0], scale * p[1], 0};
        text << "v";
        for (const int axis : axes) text << ' ' << xyz[static_cast<std::size_t>(axis)];
        text << '\n';
    }
    text << "f";
    if (corners.empty()) {
        for (std::size_t i = 0; i < outline.size(); ++i) corners.push_back(static_cast<std::int32_t>(i));
    }
    for (const std::int32_t corner : corners) text << ' ' << corner + 1;
    return text.str() + '\n';
}

TriangleMesh read(const std::string& text, Triangulation triangulation = Triangulation::ears) {
    return read_bytes(text, "a.obj", {.triangulation = triangulation});
}

Vec3d vertex(const TriangleMesh& mesh, std::size_t corner) {
    const auto& xyz = std::get<std::vector<double>>(mesh.vertices);
    const auto v = 3 * static_cast<std::size_t>(mesh.triangles[corner]);
    return {xyz[v], xyz[v + 1], xyz[v + 2]};
}

/// Expects a triangulation of the polygon without overlaps: n - 2 triangles of one orientation that meet only in edges
/// and vertices, and whose border is the polygon. `scale`: power of two by which the polygon was scaled; orient2d is
/// exact only for the unscaled one.
void expect_cut(const TriangleMesh& mesh, const Indices& corners, int axis, bool degenerate = false, double scale = 1) {
    EXPECT_TRUE(mesh.warnings.empty()) << mesh.warnings[0];
    ASSERT_EQ(mesh.triangle_count(), static_cast<std::int64_t>(corners.size()) - 2);
    int turns = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
        const auto unscaled = [&](std::size_t corner) { return (1 / scale) * vertex(mesh, corner); };
        const int turn = orient2d(unscaled(i), unscaled(i + 1), unscaled(i + 2), axis);
        if (turn != 0 && turns == 0) turns = turn;
        if (degenerate && turn == 0) continue;
        EXPECT_TRUE(turn == turns && turn != 0) << "triangle " << i / 3;
    }
    std::map<std::pair<std::int32_t, std::int32_t>, int> border;
    const auto add = [&](std::int32_t a, std::int32_t b, int n) {
        if (a != b) border[std::minmax(a, b)] += a < b ? n : -n;
    };
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        add(mesh.triangles[i], mesh.triangles[i % 3 == 2 ? i - 2 : i + 1], 1);
    for (std::size_t i = 0; i < corners.size(); ++i) add(corners[i], corners[(i + 1) % corners.size()], -1);
    for (const auto& [edge, count] : border) EXPECT_EQ(count, 0) << edge.first << ' ' << edge.second;
    Detector detector({.threads = 1});
    EXPECT_TRUE(detector.find(mesh.view(), {.weld = true}).pairs.empty());
}

/// Calls expect_cut() for polygons that start at every corner, run in both directions, and lie in planes normal to
/// every axis.
void expect_cut_however_it_lies(const Outline& outline, const Indices& given = {}, bool degenerate = false) {
    Indices corners = given;
    for (std::size_t i = 0; given.empty() && i < outline.size(); ++i) corners.push_back(static_cast<std::int32_t>(i));
    constexpr std::array<std::array<int, 3>, 3> lies{{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
    for (std::size_t start = 0; start < corners.size(); ++start) {
        std::rotate(corners.begin(), corners.begin() + 1, corners.end());
        for (const bool reversed : {false, true}) {
            if (reversed) std::reverse(corners.begin(), corners.end());
            for (int lie = 0; lie < 3; ++lie) {
                const int axis = (lie + 2) % 3;
                SCOPED_TRACE(obj_of(outline, corners, lies[static_cast<std::size_t>(lie)]));
                expect_cut(read(obj_of(outline, corners, lies[static_cast<std::size_t>(lie)])), corners,
                           lie == 0   ? 2
                           : lie == 1 ? 0
                                      : axis,
                           degenerate);
            }
        }
    }
}

const Outline chevron{{0, 0}, {4, -2}, {1, 0}, {4, 2}};
const Outline l_shape{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};

TEST(Triangulation, convex_polygon_is_fanned_from_its_first_corner) {
    for (const int n : {4, 5, 17}) {
        Outline outline;
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * std::numbers::pi * i / n;
            outline.push_back({std::cos(angle), std::sin(angle)});
        }
        const TriangleMesh ears = read(obj_of(outline)), fan = read(obj_of(outline), Triangulation::fan);
        Indices expected;
        for (std::int32_t i = 2; i < n; ++i) expected.insert(expected.end(), {0, i - 1, i});
        EXPECT_EQ(fan.triangles, expected);
        EXPECT_EQ(ears.triangles, expected);
        std::reverse(outline.begin(), outline.end());
        EXPECT_EQ(read(obj_of(outline)).triangles, expected);
    }
}

TEST(Triangulation, concave_polygon_is_cut_without_overlaps) {
    expect_cut_however_it_lies(chevron);
    expect_cut_however_it_lies(l_shape);
    expect_cut_however_it_lies(
        {{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}});
}

TEST(Triangulation, fan_of_a_concave_polygon_overlaps) {
    const TriangleMesh fan = read(obj_of({chevron[1], chevron[2], chevron[3], chevron[0]}), Triangulation::fan);
    Detector detector({.threads = 1});
    EXPECT_EQ(detector.find(fan.view()).pairs.size(), 1u);
}

TEST(Triangulation, corners_on_a_straight_edge_give_no_degenerate_triangle) {
    expect_cut_however_it_lies({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}});
    expect_cut_however_it_lies({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}});
    expect_cut_however_it_lies({{0, 0}, {1, 0}, {2, 0}, {1, 1}});
}

TEST(Triangulation, slit_can_join_a_hole_to_the_outline) {
    const Outline outline{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 1}, {1, 3}, {3, 3}, {3, 1}};
    expect_cut_however_it_lies(outline, {0, 4, 5, 6, 7, 4, 0, 1, 2, 3});
    const Outline two_holes{{0, 0}, {9, 0}, {9, 4}, {0, 4}, {1, 1}, {1, 3},
                            {3, 3}, {3, 1}, {5, 1}, {5, 3}, {7, 3}, {7, 1}};
    expect_cut_however_it_lies(two_holes, {0, 4, 5, 6, 7, 8, 9, 10, 11, 8, 7, 4, 0, 1, 2, 3});
}

TEST(Triangulation, polygon_that_passes_a_vertex_twice_is_cut_without_overlaps) {
    expect_cut_however_it_lies({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}, {0, 2}, {0, 1}}, {0, 1, 2, 3, 4, 5, 3, 6},
                               true);
}

TEST(Triangulation, polygon_whose_corner_lies_on_another_edge_is_cut_without_overlaps) {
    expect_cut_however_it_lies({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, {}, true);
    expect_cut_however_it_lies({{0, 0}, {4, 0}, {4, 4}, {3, 4}, {0, 2}, {1, 4}, {0, 4}}, {}, true);
}

TEST(Triangulation, polygons_with_spikes_are_cut_without_overlaps) {
    expect_cut_however_it_lies({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2}, {2, 2}}, {0, 1, 2, 3, 4, 5, 4}, true);
    expect_cut_however_it_lies({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {-3, 2}, {0, 2}}, {0, 1, 2, 3, 5, 4, 5}, true);
}

TEST(Triangulation, polygon_without_area_is_fanned) {
    EXPECT_EQ(read(obj_of({{0, 0}, {1, 1}, {3, 3}, {2, 2}})).triangles, (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(read(obj_of({{1, 1}, {1, 1}, {1, 1}, {1, 1}})).triangles, (Indices{0, 1, 2, 0, 2, 3}));
}

TEST(Triangulation, self_crossing_polygon_is_fanned_with_a_warning) {
    const Outline bow_tie{{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    const Outline pentagram{{0, 3}, {2, -3}, {-3, 1}, {3, 1}, {-2, -3}};
    for (const Outline& outline : {bow_tie, pentagram}) {
        const std::string text = obj_of(outline);
        const TriangleMesh mesh = read(text);
        EXPECT_EQ(mesh.triangles, read(text, Triangulation::fan).triangles);
        ASSERT_EQ(mesh.warnings.size(), 1u);
        const std::string line = "line " + std::to_string(outline.size() + 1) + ": ";
        EXPECT_NE(mesh.warnings[0].find(line + "a polygon crosses itself and becomes a fan"), std::string::npos)
            << mesh.warnings[0];
        const auto strictly = [&] { read_bytes(text, "a.obj", {.strict = true}); };
        EXPECT_EQ(error_of(strictly).code, ErrorCode::format);
        EXPECT_TRUE(read(text, Triangulation::fan).warnings.empty());
    }
    const std::string twice = obj_of(bow_tie) + "f 4 3 2 1\nf 1 2 3 4\n";
    EXPECT_NE(read(twice).warnings.at(0).find("and 2 more like that"), std::string::npos) << read(twice).warnings[0];
}

TEST(Triangulation, outline_that_covers_an_area_twice_is_fanned_with_a_warning) {
    const Outline square_and_hole{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {3, 3}, {3, 6}, {6, 6}, {6, 3}};
    const auto warns = [](const Outline& outline, const Indices& corners) {
        const TriangleMesh mesh = read(obj_of(outline, corners));
        EXPECT_EQ(mesh.warnings.size(), 1u) << obj_of(outline, corners);
        EXPECT_EQ(mesh.triangles, read(obj_of(outline, corners), Triangulation::fan).triangles);
    };
    warns(square_and_hole, {0, 1, 2, 3, 0, 4, 7, 6, 5, 4});  // the hole has the direction of the outline
    expect_cut(read(obj_of(square_and_hole, {0, 1, 2, 3, 0, 4, 5, 6, 7, 4})), {0, 1, 2, 3, 0, 4, 5, 6, 7, 4}, 2);
    warns({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 1, 2, 3, 0, 1, 2, 3});
    warns({{0, 0}, {1, 0}, {1, 1}}, {0, 1, 2, 0, 1, 2});
    warns({{0, 0}, {1, 2}, {1, 1}, {0, 2}, {2, 2}}, {0, 1, 2, 2, 0, 3, 4});
}

TEST(Triangulation, polygon_with_a_very_distant_corner_is_cut_without_overlaps) {
    const Outline notched{{1e30, 1e30}, {-1, 5}, {0, 0}, {1, 1.5}, {1.5, 0}, {5, -1}};
    expect_cut_however_it_lies(notched);
    Outline beyond_expansions = notched;
    beyond_expansions[0] = {1e305, 1e305};
    expect_cut_however_it_lies(beyond_expansions);
}

TEST(Triangulation, concave_polygons_are_cut_without_overlaps_at_extreme_scales) {
    const Outline sliver{{0, 0}, {4, 0}, {2, 0x1p-50}, {2, 0x1p-51}};  // concave by about 2^-51
    for (const double scale : {1.0, 0x1p-900, 0x1p900, 0x1p1020, 0x1p-1020}) {
        SCOPED_TRACE(scale);
        expect_cut(read(obj_of(sliver, {}, {0, 1, 2}, scale)), {0, 1, 2, 3}, 2, false, scale);
        expect_cut(read(obj_of(chevron, {1, 2, 3, 0}, {0, 1, 2}, scale)), {1, 2, 3, 0}, 2, false, scale);
    }
}

/// Returns a star-shaped outline, made concave and no longer star-shaped by moving corners where nothing crosses.
Outline random_outline(std::mt19937& random, std::size_t corners) {
    Outline outline;
    std::uniform_real_distribution<double> radius(0.1, 1), step(-1, 1);
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners);
        const double r = radius(random);
        outline.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    for (std::size_t attempt = 0; attempt < 20 * corners; ++attempt) {
        Outline moved = outline;
        moved[random() % corners] = {step(random), step(random)};
        if (read(obj_of(moved)).warnings.empty()) outline = moved;
    }
    return outline;
}

TEST(Triangulation, random_outlines_are_cut_without_overlaps) {
    std::mt19937 random(5);
    for (std::size_t round = 0; round < (thorough() ? 60u : 24u); ++round) {
        const Outline outline = random_outline(random, 4 + round % 12);
        Indices corners;
        for (std::size_t i = 0; i < outline.size(); ++i) corners.push_back(static_cast<std::int32_t>(i));
        SCOPED_TRACE(obj_of(outline));
        expect_cut(read(obj_of(outline)), corners, 2);
    }
}

TEST(Triangulation, long_comb_is_cut_without_overlaps) {
    constexpr int teeth = sanitized ? 5'000 : 20'000;
    Outline comb{{0, -1}};
    Indices corners{0};
    for (int i = 0; i < teeth; ++i) {
        comb.push_back({static_cast<double>(i), i % 2 ? 10.0 + i % 7 : 0});
        corners.push_back(i + 1);
    }
    comb.push_back({teeth, -1});
    corners.push_back(teeth + 1);
    std::reverse(corners.begin(), corners.end());
    expect_cut(read(obj_of(comb, corners)), corners, 2);
}

TEST(Triangulation, concave_polygons_of_ply_and_off_are_cut_without_overlaps) {
    const std::string vertices = "0 0 0\n4 -2 0\n1 0 0\n4 2 0\n";
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
        "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const Indices ears{3, 0, 1, 3, 1, 2}, fan{1, 2, 3, 1, 3, 0};
    for (const auto& [name, text] : std::map<std::string, std::string>{
             {"a.ply", header + vertices + "4 1 2 3 0\n"}, {"a.off", "OFF\n4 1 0\n" + vertices + "4 1 2 3 0\n"}}) {
        expect_cut(read_bytes(text, name), {1, 2, 3, 0}, 2);
        EXPECT_EQ(read_bytes(text, name, {.triangulation = Triangulation::fan}).triangles, fan);
    }
}

TEST(Polygons, each_triangle_has_the_number_of_its_face) {
    const TriangleMesh mesh =
        read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nf 1 2 3\nf 1 2 3 4\nf 2 3 4\nf 1 2 3 4 5\n");
    EXPECT_EQ(mesh.polygons.of_triangle, (Indices{0, 1, 1, 2, 3, 3, 3}));
    EXPECT_EQ(mesh.polygons.offsets, (std::vector<std::int64_t>{0, 3, 7, 10, 15}));
    EXPECT_EQ(mesh.polygons.corners, (Indices{0, 1, 2, 0, 1, 2, 3, 1, 2, 3, 0, 1, 2, 3, 4}));
    EXPECT_EQ(mesh.polygons.count(), 4);
}

TEST(Polygons, polygons_are_absent_if_all_faces_are_triangles) {
    const TriangleMesh mesh = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 3 2 1\n");
    EXPECT_TRUE(mesh.polygons.empty());
    EXPECT_EQ(mesh.polygons.count(), 0);
    EXPECT_TRUE(mesh.polygons.offsets.empty() && mesh.polygons.corners.empty());
}

TEST(Polygons, corners_of_polygons_are_renumbered_by_welding) {
    const std::string text = "v 9 9 9\nv 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 3 4 5 6\n";
    const TriangleMesh mesh = read_bytes(text, "a.obj", {.weld = Weld::yes});
    EXPECT_EQ(mesh.polygons.corners, (Indices{1, 2, 3, 4}));
}

}  // namespace
}  // namespace crumple::io::test
