// Tests of depths of vertices and of bounds on the depth, against all pairs of vertices and triangles in rationals, and
// against random points.

#include "search/depth/overlap_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exact/distance/exact_nearest.h"
#include "exact/intersection/exact_intersection.h"
#include "exact/overlap/exact_crossing.h"
#include "overlaps/closed_bodies.h"
#include "overlaps/placed_soups.h"
#include "rounds.h"
#include "search/depth/overlap_depth_bound.h"

namespace crumple {
namespace {

using test::Backwards;
using test::box;
using test::Dice;
using test::Placed;
using test::scaled;
using test::subdivided;
using Soup = test::Soup<double>;

std::int32_t winding_at(const Vec3d& p, const Placed& other) {
    std::int32_t winding = 0;
    for (std::int32_t face = 0; face < other.faces(); ++face)
        winding += winding_along_ray(p, other.surface.corners(face), Shift::forward);
    return winding;
}

WindingSteps windings_of(const Placed& of, const Placed& other) {
    WindingSteps steps;
    for (std::int32_t place = 0; place < of.closed.places(); ++place)
        steps.add(place, place + 1,
                  winding_at(of.points[static_cast<std::size_t>(of.closed.vertex_at_place(place))], other));
    steps.make_intervals();
    return steps;
}

/// Expects that `rounded` is the float64 number nearest to a distance.
void expect_rounded(double rounded, const RationalDistance& distance) {
    const auto wide = [](const Integer& x) { return Rational(mp::cpp_int(x)); };
    Rational squared = wide(distance.quotient().numerator) / wide(distance.quotient().denominator);
    const mp::cpp_int scale = mp::cpp_int(1) << 2 * std::abs(distance.exponent());
    squared = distance.exponent() < 0 ? Rational(squared / Rational(scale)) : Rational(squared * Rational(scale));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const Rational at(rounded), below = Rational(at + Rational(std::nextafter(rounded, 0.0))) / 2,
                                above = Rational(at + Rational(std::nextafter(rounded, infinity))) / 2;
    EXPECT_LE(Rational(below * below), squared);
    EXPECT_GE(Rational(above * above), squared);
}

std::vector<VertexDepth> depths_in_rationals(const Placed& of, const Placed& other) {
    std::vector<VertexDepth> depths;
    for (std::int32_t place = 0; place < of.closed.places(); ++place) {
        const std::int32_t vertex = of.closed.vertex_at_place(place);
        const Vec3d& p = of.points[static_cast<std::size_t>(vertex)];
        if (winding_at(p, other) == 0) continue;
        std::int32_t triangle = 0;
        RationalDistance least(vertex_and_face(p, other.surface.corners(0)));
        for (std::int32_t face = 1; face < other.faces(); ++face) {
            RationalDistance distance(vertex_and_face(p, other.surface.corners(face)));
            if (compare(distance, least) < 0) least = distance, triangle = face;
        }
        if (least.touching()) continue;
        expect_rounded(least.rounded(), least);
        const Features features = vertex_and_face(p, other.surface.corners(triangle));
        depths.push_back({vertex, least.rounded(), closest_points(features, least)[1], triangle});
    }
    std::sort(depths.begin(), depths.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    return depths;
}

std::vector<VertexDepth> found_depths(const Placed& of, const Placed& other) {
    ParallelFor workers;
    Backwards backwards;
    Cancellation none;
    std::int64_t rational = 0;
    const WindingSteps windings = windings_of(of, other);
    const auto depths = find_depths(of.surface, windings, *other.tree, workers, none, rational);
    EXPECT_EQ(find_depths(of.surface, windings, *other.tree, backwards, none, rational), depths);
    return depths;
}

/// Returns the number of depths.
std::size_t expect_exact_depths(const Soup& a, const Soup& b) {
    const Placed first(a), second(b);
    const auto of_first = found_depths(first, second), of_second = found_depths(second, first);
    EXPECT_EQ(of_first, depths_in_rationals(first, second));
    EXPECT_EQ(of_second, depths_in_rationals(second, first));
    return of_first.size() + of_second.size();
}

TEST(OverlapDepth, depths_equal_those_in_rationals) {
    std::size_t count = 0;
    for (int seed = 0; seed < scaled_rounds(150); ++seed) {
        const auto bodies = test::closed_bodies(static_cast<unsigned>(seed), 2, seed % 2 == 0, false);
        count += expect_exact_depths(bodies.soups[0], bodies.soups[1]);
        Soup split = bodies.soups[1];
        test::add_t_junction(split);
        count += expect_exact_depths(bodies.soups[0], split);
    }
    EXPECT_GT(count, 20u);
}

TEST(OverlapDepth, depths_equal_those_in_rationals_for_surfaces_of_many_triangles) {
    std::size_t count = 0;
    for (int seed = 0; seed < 6; ++seed) {
        const auto bodies = test::closed_bodies(static_cast<unsigned>(seed), 2, seed % 2 == 0, false);
        count += expect_exact_depths(subdivided(subdivided(bodies.soups[0])), subdivided(bodies.soups[1]));
    }
    EXPECT_GT(count, 20u);
}

TEST(OverlapDepth, depths_of_extreme_coordinates_equal_those_in_rationals) {
    std::size_t count = 0;
    for (const double factor : {1e-320, 1e-120, 1e120, 5e306})
        for (int seed = 0; seed < scaled_rounds(12); ++seed) {
            const auto bodies = test::closed_bodies(static_cast<unsigned>(seed), 2, seed % 2 == 0, false);
            count += expect_exact_depths(scaled(bodies.soups[0], factor), scaled(bodies.soups[1], factor));
        }
    count += expect_exact_depths(box(-1e-120, 1e-120), box(-1e120, 1e120));
    EXPECT_GT(count, 10u);
}

TEST(OverlapDepth, lowest_of_equally_close_triangles_is_reported) {
    const Placed small(box(-1, 1)), large(box(-2, 2));
    const auto depths = found_depths(small, large);
    ASSERT_EQ(depths.size(), 8u);
    EXPECT_EQ(depths[0], (VertexDepth{0, 1, {-1, -1, -2}, 0}));
    EXPECT_EQ(depths[7], (VertexDepth{7, 1, {1, 1, 2}, 3}));
}

TEST(OverlapDepth, vertices_on_the_other_surface_have_no_depth) {
    const Placed low(box(-1, 1)), high(box(-0.5, 0.5, 0.5));
    EXPECT_EQ(found_depths(high, low).size(), 4u);
    EXPECT_TRUE(found_depths(low, low).empty());
}

std::vector<Pair> pairs_of(const Placed& a, const Placed& b) {
    std::vector<Pair> pairs;
    for (std::int32_t i = 0; i < a.faces(); ++i)
        for (std::int32_t j = 0; j < b.faces(); ++j)
            if (!intersect_rationally({a.surface.corners(i), {0, 1, 2}}, {b.surface.corners(j), {3, 4, 5}})
                     .points.empty())
                pairs.push_back({i, j});
    return pairs;
}

DepthBounds bounds_of(const Placed& a, const Placed& b, double tolerance, MemoryMeter& meter) {
    ParallelFor workers;
    Backwards backwards;
    Cancellation none;
    const WindingSteps windings_a = windings_of(a, b), windings_b = windings_of(b, a);
    const auto depths_a = found_depths(a, b), depths_b = found_depths(b, a);
    const std::array<DepthSide, 2> sides{DepthSide{&a.surface, &windings_a, depths_a, a.tree.get()},
                                         DepthSide{&b.surface, &windings_b, depths_b, b.tree.get()}};
    const std::vector<Pair> pairs = pairs_of(a, b);
    const DepthBounds bounds = find_depth_bounds(sides, pairs, tolerance, workers, meter, none);
    const DepthBounds same = find_depth_bounds(sides, pairs, tolerance, backwards, meter, none);
    EXPECT_EQ(bounds.lower, same.lower);
    EXPECT_EQ(bounds.upper, same.upper);
    for (const auto& depths : {depths_a, depths_b})
        for (const VertexDepth& depth : depths) EXPECT_LE(depth.depth, bounds.upper);
    return bounds;
}

DepthBounds bounds_of(const Placed& a, const Placed& b, double tolerance) {
    MemoryMeter meter;
    return bounds_of(a, b, tolerance, meter);
}

/// Returns the greatest depth of random points of the faces of `of`, divided by `unit`.
double sampled_depth(Dice& dice, const Placed& of, const Placed& other, double unit) {
    double greatest = 0;
    for (std::int32_t face = 0; face < of.faces(); ++face)
        for (int sample = 0; sample < 40; ++sample) {
            const TrianglePoints c = of.surface.corners(face);
            double s = dice.number(), t = dice.number();
            if (s + t > 1) s = 1 - s, t = 1 - t;
            const Vec3d p = c[0] + (s * (c[1] - c[0]) + t * (c[2] - c[0]));
            if (winding_at(p, other) == 0) continue;
            double least = std::numeric_limits<double>::infinity();
            for (std::int32_t f = 0; f < other.faces(); ++f) {
                TrianglePoints q = other.surface.corners(f);
                for (Vec3d& x : q) x = (1 / unit) * x;
                least = std::min(least, GuessedPoint((1 / unit) * p, q).upper);
            }
            greatest = std::max(greatest, least);
        }
    return greatest;
}

TEST(OverlapDepth, bounds_hold_at_random_points) {
    Dice dice(5);
    for (const double unit : {1.0, 1e-120, 1e120})
        for (int seed = 0; seed < scaled_rounds(unit == 1 ? 60 : 10); ++seed) {
            const auto bodies = test::closed_bodies(static_cast<unsigned>(seed), 2, seed % 2 == 0, false);
            const Placed a(scaled(bodies.soups[0], unit)), b(scaled(bodies.soups[1], unit));
            for (const double tolerance : {0.3, 0.01}) {
                const DepthBounds bounds = bounds_of(a, b, tolerance * unit);
                EXPECT_LE(bounds.lower, bounds.upper);
                EXPECT_LE(bounds.upper - bounds.lower, tolerance * unit * (1 + 1e-9)) << seed;
                for (const double depth : {sampled_depth(dice, a, b, unit), sampled_depth(dice, b, a, unit)})
                    EXPECT_LE(depth * unit, bounds.upper + 1e-12 * unit) << seed;
            }
        }
}

TEST(OverlapDepth, bounds_of_crossed_bars_are_tight_though_no_vertex_is_inside) {
    Soup bar = box(-1, 1), other = box(-1, 1);
    for (auto& p : bar.vertices) p[0] *= 10;
    for (auto& p : other.vertices) p[1] *= 10, p[2] *= 0.5;
    const Placed a(bar), b(other);
    EXPECT_TRUE(found_depths(a, b).empty());
    EXPECT_TRUE(found_depths(b, a).empty());
    const DepthBounds bounds = bounds_of(a, b, 1e-4);
    EXPECT_NEAR(bounds.lower, 1, 1e-4);  // at the middles of two sides of the second bar
    EXPECT_GE(bounds.upper, 1);
    EXPECT_LE(bounds.upper, bounds.lower + 1e-4);
}

TEST(OverlapDepth, memory_of_pieces_is_counted_and_limited) {
    const auto bodies = test::closed_bodies(2, 2, false, false);
    const Placed a(bodies.soups[0]), b(bodies.soups[1]);
    MemoryMeter coarse, fine, limited;
    bounds_of(a, b, 0.5, coarse);
    bounds_of(a, b, 1e-4, fine);
    EXPECT_GT(coarse.peak, 0);
    EXPECT_GT(fine.peak, 2 * coarse.peak);
    EXPECT_EQ(fine.used, 0);
    limited.limit = fine.peak - 1;
    EXPECT_THROW(bounds_of(a, b, 1e-4, limited), MemoryMeter::Exceeded);
    EXPECT_EQ(limited.used, 0);
}

TEST(OverlapDepth, tolerance_0_ends) {
    const Placed a(box(-1, 1)), b(box(-0.7, 0.7, 0.9));
    for (const double tolerance : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        const DepthBounds bounds = bounds_of(a, b, tolerance);
        EXPECT_LE(bounds.upper - bounds.lower, 1e-5);
    }
}

TEST(OverlapDepth, surfaces_that_are_apart_have_depth_0) {
    const DepthBounds bounds = bounds_of(Placed(box(-1, 1)), Placed(box(-1, 1, 5)), 0.1);
    EXPECT_EQ(bounds.lower, 0);
    EXPECT_EQ(bounds.upper, 0);
}

}  // namespace
}  // namespace crumple
