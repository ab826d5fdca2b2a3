// Hard placements with known results, on the cpu and on the reference backend.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "overlaps/closed_bodies.h"

namespace crumple {
namespace {

using Soup = test::Soup<double>;
using Numbers = std::array<double, 3>;
using test::joined;

Soup box(const Numbers& low, const Numbers& high) {
    Soup soup;
    for (int v = 0; v < 8; ++v)
        soup.vertices.push_back({v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]});
    soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return soup;
}
/// Returns a cone of triangles from its tip down to a polygon, with its floor.
Soup cone(const Numbers& tip, const std::vector<Numbers>& rim) {
    Soup soup;
    soup.vertices.push_back(tip);
    for (const Numbers& p : rim) soup.vertices.push_back(p);
    const auto n = static_cast<std::int32_t>(rim.size());
    for (std::int32_t i = 0; i < n; ++i) soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    for (std::int32_t i = 1; i + 1 < n; ++i) soup.triangles.push_back({1, 2 + i, 1 + i});
    return soup;
}
/// Returns a sphere made of `rings` rings of triangles, above the plane z = 0 if `sign` is 1, below it if −1. Spheres
/// of opposite signs touch at their common pole, the origin.
Soup ball(int rings, double sign) {
    Soup soup;
    const int around = 2 * rings;
    soup.vertices.push_back({0, 0, 0});
    soup.vertices.push_back({0, 0, 2 * sign});
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            const double polar = M_PI * i / rings, turn = 2 * M_PI * j / around;
            soup.vertices.push_back(
                {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), sign * (1 - std::cos(polar))});
        }
    const auto at = [&](int i, int j) {
        return i == 0 ? 0 : i == rings ? 1 : static_cast<std::int32_t>(2 + (i - 1) * around + j % around);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            if (i > 0) soup.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + 1 < rings) soup.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
        }
    if (sign > 0)
        for (auto& t : soup.triangles) std::swap(t[1], t[2]);
    return soup;
}
/// Returns a body with three sides (a tent), above a zigzag ridge if `sign` is 1, below it if −1. Tents of opposite
/// signs share the ridge.
Soup tent(int vertices, double sign) {
    Soup soup;
    for (int i = 0; i < vertices; ++i) soup.vertices.push_back({0.25 * (i % 2), 1.0 * i, 0.125 * (i % 3)});
    for (int i = 0; i < vertices; ++i) soup.vertices.push_back({-1, 1.0 * i, sign});
    for (int i = 0; i < vertices; ++i) soup.vertices.push_back({2, 1.0 * i, sign});
    for (std::int32_t i = 0; i + 1 < vertices; ++i) {
        const std::int32_t ridge = i, left = vertices + i, right = 2 * vertices + i;
        for (const auto& [a, b] : {std::pair{ridge, left}, std::pair{left, right}, std::pair{right, ridge}}) {
            soup.triangles.push_back({a, a + 1, b});
            soup.triangles.push_back({b, a + 1, b + 1});
        }
    }
    const std::int32_t last = vertices - 1;
    soup.triangles.push_back({0, vertices, 2 * vertices});
    soup.triangles.push_back({last, 2 * vertices + last, vertices + last});
    if (sign < 0)
        for (auto& t : soup.triangles) std::swap(t[1], t[2]);
    return soup;
}

class KnownOverlaps : public testing::Test {
   protected:
    /// Returns the result of the cpu backend, and expects the same of the reference.
    const Overlaps& find(const std::vector<Soup>& soups, const std::vector<Pose>& poses = {}) {
        std::vector<Shape> shapes;
        std::vector<Body> bodies;
        for (const Soup& soup : soups) {
            shapes.emplace_back(soup.view());
            bodies.push_back({.shape = static_cast<std::int32_t>(bodies.size())});
        }
        const World world{shapes, bodies, poses};
        const OverlapQuery query{.gradient = true, .curves = true, .windings = true};
        const Overlaps& found = cpu_.find(world, query);
        EXPECT_EQ(test::difference(found, reference_.find(world, query)), "");
        return found;
    }
    const Overlaps& find_with_itself(const Soup& soup) {
        const Overlaps& found = cpu_.find(Scene(soup.view()), OverlapQuery{.gradient = true});
        EXPECT_EQ(test::difference(found, reference_.find(Scene(soup.view()), OverlapQuery{.gradient = true})), "");
        return found;
    }
    static void expect_row(const Overlaps& found, std::size_t row, OverlapRelation relation, double volume,
                           const Numbers& area_vector) {
        ASSERT_LT(row, found.bodies.size());
        EXPECT_EQ(found.relation[row], relation);
        EXPECT_EQ(found.volume[row], volume);
        EXPECT_EQ(found.area_vector[row], area_vector);
    }

    Detector cpu_{Options{.backend = Backend::cpu, .threads = 2}};
    Detector reference_{Options{.backend = Backend::reference}};
};

TEST_F(KnownOverlaps, aligned_stack_touches_with_the_normal_of_its_faces) {
    const Overlaps& found = find({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 1}, {1, 1, 2}), box({0, 0, 2}, {1, 1, 3})});
    ASSERT_EQ(found.count, 2);
    for (std::size_t row = 0; row < 2; ++row) {
        expect_row(found, row, OverlapRelation::touching, 0, {0, 0, 0.5});
        EXPECT_EQ(found.normal[row], (Numbers{0, 0, 1}));
        EXPECT_EQ(found.contact_area[row], 1);
    }
}

TEST_F(KnownOverlaps, contact_area_in_a_tilted_plane_is_the_exact_area_rounded) {
    std::vector<Soup> soups{box({0, 0, 0}, {1, 1, 1}), box({0.25, 0, 1}, {1.25, 1, 2})};
    for (Soup& soup : soups)
        for (auto& [x, y, z] : soup.vertices) {
            const double along = x + z, up = z - x;
            x = along, z = up;
        }
    const Overlaps& found = find(soups);
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.contact_area[0], std::sqrt(1.125));  // 3/4 of a square with a side of root 2
}

TEST_F(KnownOverlaps, two_pegs_cross_a_box_in_four_curves) {
    const Soup plate = box({0, 0, 0}, {4, 4, 1}), one = box({1, 1, -1}, {1.5, 1.5, 2}),
               other = box({2, 2, -1}, {3, 3, 2});
    const Overlaps& found = cpu_.find(Scene(plate.view(), joined(one, other).view()), OverlapQuery{.curves = true});
    ASSERT_EQ(found.count, 1);
    ASSERT_EQ(found.curve_closed.size(), 4u);
    Numbers sum{};
    std::vector<double> areas;
    for (std::size_t j = 0; j < 4; ++j) {
        EXPECT_EQ(found.curve_closed[j], 1);
        const Numbers& area = found.curve_area_vector[j];
        for (std::size_t k = 0; k < 3; ++k) sum[k] += area[k];
        areas.push_back(area[2]);
        const std::int64_t begin = found.curve_point_offsets[j], end = found.curve_point_offsets[j + 1];
        EXPECT_EQ(found.curve_points[begin], found.curve_points[end - 1]);
        for (std::int64_t i = begin; i < end; ++i)
            EXPECT_TRUE(found.curve_points[i][2] == 0 || found.curve_points[i][2] == 1);
        EXPECT_EQ(found.curve_triangles[end - 1], (Pair{-1, -1}));
    }
    EXPECT_EQ(sum, found.area_vector[0]);
    std::sort(areas.begin(), areas.end());
    EXPECT_EQ(areas, (std::vector<double>{-1, -0.25, 0.25, 1}));
}

TEST_F(KnownOverlaps, boxes_that_touch_in_an_edge_are_cut_in_two_curves) {
    const Soup twins = joined(box({0, 0, 0}, {1, 1, 2}), box({1, 1, 0}, {2, 2, 2})),
               plate = box({-1, -1, 0.5}, {3, 3, 9});
    const Overlaps& found = cpu_.find(Scene(twins.view(), plate.view()), OverlapQuery{.weld = true, .curves = true});
    ASSERT_EQ(found.curve_closed.size(), 2u);
    EXPECT_EQ(found.curve_area_vector[0], (Numbers{0, 0, 1}));
    EXPECT_EQ(found.curve_area_vector[1], (Numbers{0, 0, 1}));
}

TEST_F(KnownOverlaps, sheet_through_a_box_has_an_open_curve) {
    Soup sheet;
    sheet.vertices = {{0.5, 0.5, 0.5}, {3, 0.5, 0.5}, {3, 3, 0.75}, {0.5, 3, 0.5}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Soup cube = box({0, 0, 0}, {1, 1, 1});
    const OverlapQuery query{.open = OpenSurfaces::curves, .curves = true};
    const Overlaps& found = cpu_.find(Scene(sheet.view(), cube.view()), query);
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.relation[0], OverlapRelation::undefined);
    EXPECT_TRUE(std::isnan(found.volume[0]) && std::isnan(found.normal[0][0]));
    ASSERT_EQ(found.curve_closed.size(), 1u);
    EXPECT_EQ(found.curve_closed[0], 0);
    EXPECT_TRUE(std::isnan(found.curve_area_vector[0][0]));
    EXPECT_EQ(test::difference(found, reference_.find(Scene(sheet.view(), cube.view()), query)), "");
    EXPECT_FALSE(cpu_.find(Scene(sheet.view(), cube.view()), OverlapQuery{.open = OpenSurfaces::skip}).any);
}

TEST_F(KnownOverlaps, three_equal_boxes_give_three_pairs_of_equal_bodies) {
    const Soup one = box({0, 0, 0}, {1, 2, 1});
    const Overlaps& found = find({one, one, one});
    ASSERT_EQ(found.count, 3);
    for (std::size_t row = 0; row < 3; ++row) expect_row(found, row, OverlapRelation::equal, 2, {0, 0, 0});
}

TEST_F(KnownOverlaps, saddle_with_its_tip_on_a_face_of_a_box_overlaps_the_box) {
    // The rim goes up and down twice around the tip, which lies on the face of a box.
    const Soup saddle = cone(
        {0, 0, 0}, {{2, 0, 1}, {1, 1, -1}, {0, 2, 1}, {-1, 1, -1}, {-2, 0, 1}, {-1, -1, -1}, {0, -2, 1}, {1, -1, -1}});
    const Overlaps& found = find({saddle, box({-4, -4, -4}, {4, 4, 0})});
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.relation[0], OverlapRelation::overlapping);
}

TEST_F(KnownOverlaps, overlap_of_a_two_sided_membrane_with_a_box_has_no_volume) {
    Soup membrane;
    membrane.vertices = {{-1, -1, 0.5}, {2, -1, 0.5}, {0.5, 3, 0.5}};
    membrane.triangles = {{0, 1, 2}, {0, 2, 1}};
    const Overlaps& found = find({membrane, box({0, 0, 0}, {1, 1, 1})});
    ASSERT_EQ(found.count, 1);
    expect_row(found, 0, OverlapRelation::touching, 0, {0, 0, 0});
}

TEST_F(KnownOverlaps, overlap_with_a_body_of_two_copies_counts_twice) {
    const Soup slab = box({0, 0, 0}, {4, 4, 1}), twice = joined(slab, slab);
    const Overlaps& found = find({twice, box({1, 1, 0.5}, {2, 2, 2})});
    expect_row(found, 0, OverlapRelation::overlapping, 1, {0, 0, 2});
    const Overlaps& alone = find_with_itself(twice);
    ASSERT_EQ(alone.count, 1);
    EXPECT_EQ(alone.volume[0], 16);
    EXPECT_EQ(alone.body_volume[0], 32);
    EXPECT_EQ(alone.is_solid[0], 0);
}

TEST_F(KnownOverlaps, box_that_touches_another_from_inside_is_inside) {
    const Overlaps& found = find({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {4, 4, 4})});
    expect_row(found, 0, OverlapRelation::first_inside, 1, {0.5, 0.5, 0.5});
    EXPECT_EQ(found.statistics.triangles, 24);
}

TEST_F(KnownOverlaps, body_without_triangles_is_a_solid_of_volume_0) {
    Soup vertices = box({0, 0, 0}, {1, 1, 1});
    vertices.triangles.clear();
    EXPECT_EQ(find({vertices, box({0, 0, 0}, {1, 1, 1})}).count, 0);
    const Overlaps& alone = find_with_itself(vertices);
    EXPECT_EQ(alone.body_volume[0], 0);
    EXPECT_EQ(alone.is_solid[0], 1);
}

TEST_F(KnownOverlaps, two_tents_that_share_a_ridge_touch) {
    const Overlaps& found = find({tent(12, -1), tent(12, 1)});
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.relation[0], OverlapRelation::touching);
    EXPECT_EQ(found.volume[0], 0);
}

TEST_F(KnownOverlaps, mirrored_spheres_touch_at_a_pole) {
    const Overlaps& found = find({ball(6, -1), ball(6, 1)});
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.relation[0], OverlapRelation::touching);
    EXPECT_EQ(found.volume[0], 0);
}

TEST_F(KnownOverlaps, normal_and_mean_depth_are_right_at_extreme_sizes) {
    for (const double size : {1e-120, 1e-40, 1e40, 1e120}) {
        SCOPED_TRACE(size);
        const Overlaps& found =
            find({box({0, 0, 0}, {size, size, size}), box({size / 2, 0, 0}, {2 * size, size, size})});
        ASSERT_EQ(found.count, 1);
        EXPECT_EQ(found.relation[0], OverlapRelation::overlapping);
        EXPECT_EQ(found.normal[0], (Numbers{1, 0, 0}));
        EXPECT_DOUBLE_EQ(found.mean_depth[0], size / 2);
    }
}

TEST_F(KnownOverlaps, mirroring_pose_does_not_turn_a_body_inside_out) {
    Pose mirrored, still;
    mirrored.rows[0] = -1;
    const Overlaps& found = find({box({-1, 0, 0}, {0, 1, 1}), box({0.5, 0, 0}, {2, 1, 1})}, {mirrored, still});
    expect_row(found, 0, OverlapRelation::overlapping, 0.5, {1, 0, 0});
}

}  // namespace
}  // namespace crumple
