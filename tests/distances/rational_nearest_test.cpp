// Tests of the reference: distances of two triangles in rational arithmetic.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "distances/random_triangles.h"
#include "exact/distance/exact_nearest.h"

namespace crumple::test {
namespace {

constexpr TrianglePoints flat{Vec3d{0, 0, 0}, Vec3d{4, 0, 0}, Vec3d{0, 4, 0}};

Vec3d minus_zero_free(const Vec3d& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

void expect_points(const RationalNearest& nearest, const Vec3d& a, const Vec3d& b) {
    EXPECT_EQ(nearest.points()[0], a);
    EXPECT_EQ(nearest.points()[1], b);
}

TEST(RationalNearest, measures_a_vertex_above_a_face) {
    const TrianglePoints above{Vec3d{1, 1, 2}, Vec3d{1, 2, 5}, Vec3d{2, 1, 5}};
    const RationalNearest nearest(flat, above), other(above, flat);
    EXPECT_FALSE(nearest.touching());
    EXPECT_EQ(nearest.squared(), 4);
    expect_points(nearest, {1, 1, 0}, {1, 1, 2});
    expect_points(other, {1, 1, 2}, {1, 1, 0});
    EXPECT_TRUE(nearest.within(2));
    EXPECT_FALSE(nearest.within(std::nextafter(2, 0)));
}
TEST(RationalNearest, measures_two_edges_across_each_other) {
    const TrianglePoints across{Vec3d{2, -1, 3}, Vec3d{2, 1, 3}, Vec3d{2, 0, 9}};
    const TrianglePoints below{Vec3d{0, 0, 0}, Vec3d{4, 0, 0}, Vec3d{2, 0, -4}};
    const RationalNearest nearest(below, across);
    EXPECT_EQ(nearest.squared(), 9);
    expect_points(nearest, {2, 0, 0}, {2, 0, 3});
}
TEST(RationalNearest, is_zero_where_an_edge_pierces_a_face) {
    const TrianglePoints through{Vec3d{1, 1, -1}, Vec3d{1, 1, 1}, Vec3d{9, 9, 1}};
    const RationalNearest nearest(flat, through);
    EXPECT_TRUE(nearest.touching());
    EXPECT_EQ(nearest.squared(), 0);
    EXPECT_TRUE(nearest.within(0));
    expect_points(nearest, {1, 1, 0}, {1, 1, 0});
}
TEST(RationalNearest, takes_the_lexicographically_first_common_point) {
    const TrianglePoints inside{Vec3d{1, 0.5, 0}, Vec3d{0.5, 1, 0}, Vec3d{1, 1, 0}};
    expect_points(RationalNearest(flat, inside), {0.5, 1, 0}, {0.5, 1, 0});
}
TEST(RationalNearest, measures_collapsed_triangles) {
    const TrianglePoints point{Vec3d{1, 1, 7}, Vec3d{1, 1, 7}, Vec3d{1, 1, 7}};
    const TrianglePoints segment{Vec3d{-1, -3, 0}, Vec3d{-1, 9, 0}, Vec3d{-1, 2, 0}};
    EXPECT_EQ(RationalNearest(flat, point).squared(), 49);
    EXPECT_EQ(RationalNearest(flat, segment).squared(), 1);
    EXPECT_EQ(RationalNearest(segment, point).squared(), 4 + 49);
    EXPECT_TRUE(RationalNearest(point, point).touching());
}
TEST(RationalNearest, rounds_overflowing_squares_to_infinity) {
    TrianglePoints far = flat;
    for (Vec3d& p : far) p.x = 0x1p1000;
    const RationalNearest nearest(flat, far);
    EXPECT_TRUE(std::isinf(nearest.squared()));
    EXPECT_TRUE(nearest.within(0x1p1001));
    EXPECT_FALSE(nearest.within(0x1p999));
    TrianglePoints farther = far;
    farther[0].x = farther[1].x = farther[2].x = 0x1p1001;
    EXPECT_LT(compare(nearest, RationalNearest(flat, farther)), 0);
}

/// Checks that no sampled pair of points is closer than the distance, and that the reported points are at that
/// distance.
TEST(RationalNearest, no_sampled_points_are_closer_than_the_distance) {
    for_triangles(60, [](RandomTriangles& random, double apart) {
        const TrianglePoints a = random(0), b = random(apart);
        const RationalNearest nearest(a, b);
        const double squared = nearest.squared(), slack = 1e-12;
        const Witnesses points = nearest.points();
        const Vec3d difference = points[0] - points[1];
        ASSERT_NEAR(dot(difference, difference), squared, slack);
        constexpr int steps = 7;
        const auto each = [&](const TrianglePoints& t, auto visit) {
            for (int i = 0; i <= steps; ++i)
                for (int j = 0; i + j <= steps; ++j)
                    visit(t[0] + (1.0 * i / steps) * (t[1] - t[0]) + (1.0 * j / steps) * (t[2] - t[0]));
        };
        each(a,
             [&](const Vec3d& p) { each(b, [&](const Vec3d& q) { ASSERT_GE(dot(p - q, p - q), squared - slack); }); });
        // Each point lies in its own triangle up to rounding.
        for (std::size_t side = 0; side < 2; ++side) {
            const TrianglePoints point{points[side], points[side], points[side]};
            ASSERT_LT(RationalNearest(side == 0 ? a : b, point).squared(), 1e-24);
            ASSERT_EQ(minus_zero_free(points[side]), points[side]);
        }
    });
}
TEST(RationalNearest, distance_does_not_depend_on_the_order_of_the_two_triangles) {
    for_triangles(60, [](RandomTriangles& random, double apart) {
        const TrianglePoints a = random(0), b = random(apart);
        const RationalNearest one(a, b), other(b, a);
        ASSERT_EQ(one.touching(), other.touching());
        ASSERT_EQ(one.squared(), other.squared());
        ASSERT_EQ(compare(one, other), 0);
    });
}

}  // namespace
}  // namespace crumple::test
