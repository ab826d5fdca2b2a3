// Compares float64 bounds on the distance of two triangles, and the choice among several pairs, with rational
// arithmetic.

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "distances/random_triangles.h"
#include "exact/distance/decide_nearest.h"

namespace crumple::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(FilteredNearest, bounds_the_distance) {
    int apart_proven = 0, all = 0;
    for_triangles(1000, [&](RandomTriangles& random, double apart) {
        const TrianglePoints a = random(0), b = random(apart);
        const FilteredNearest quick(a, b);
        const RationalNearest exact(a, b);
        if (exact.touching()) {
            ASSERT_EQ(quick.lower(), 0);
            ASSERT_GE(quick.upper(), 0);
            return;
        }
        ASSERT_TRUE(exact.within(quick.upper()));
        ASSERT_FALSE(exact.within(std::nextafter(quick.lower(), 0.0)) && quick.lower() > 0);
        ++all;
        apart_proven += quick.lower() > 0.999999 * quick.upper();
    });
    EXPECT_GT(apart_proven, all * 99 / 100) << "nearly always the bounds meet";
}
TEST(FilteredNearest, gives_no_bounds_for_huge_numbers) {
    TrianglePoints a = RandomTriangles(Lattice::fine, 1)(0), b = RandomTriangles(Lattice::fine, 2)(5);
    for (TrianglePoints* t : {&a, &b})
        for (Vec3d& p : *t) p = 0x1p300 * p;
    const FilteredNearest quick(a, b);
    EXPECT_EQ(quick.lower(), 0);
    EXPECT_EQ(quick.upper(), infinity);
}

/// Closest parts are the vertices, edges or faces in which two triangles are closest. The triangles of this test share
/// corners, so that one pair of parts belongs to several pairs of triangles.
TEST(ClosestParts, recognised_pairs_of_triangles_have_the_distance_of_the_closest_parts) {
    int same = 0, others = 0;
    for_triangles(300, [&](RandomTriangles& random, double) {
        const TrianglePoints some = random(0), more = random(0), far = random(6), farther = random(6);
        const TrianglePoints a{some[0], some[1], more[0]}, b{far[0], far[1], farther[0]};
        const FilteredNearest quick(a, b);
        const RationalNearest exact(a, b);
        const ClosestParts parts(a, b, quick);
        const TrianglePoints as[]{a, some, more, {some[0], more[0], more[1]}, {more[0], some[0], some[1]}};
        const TrianglePoints bs[]{b, far, farther, {far[1], farther[0], farther[1]}, {farther[0], far[0], far[1]}};
        for (const TrianglePoints& s : as)
            for (const TrianglePoints& t : bs) {
                const bool claimed = parts.are_closest_of(s, t);
                const bool equal = compare(RationalNearest(s, t), exact) == 0;
                if (claimed) {
                    // s and t have the distance of the parts. The distance of a and b may be less.
                    const RationalDistance distance(parts.features());
                    ASSERT_EQ(distance.squared(), RationalNearest(s, t).squared());
                }
                same += claimed;
                others += equal && !claimed;
            }
    });
    EXPECT_GT(same, 2 * others) << "most ties are seen without rational arithmetic";
}

struct Expected {
    RationalNearest least;
    Pair triangles;
};

void compare_with_rational(Array<NearestCandidate>& candidates, double radius) {
    std::optional<Expected> expected;
    const NearestCandidate* closest = nullptr;
    double upper = infinity;
    for (NearestCandidate& candidate : candidates) {
        RationalNearest exact(candidate.a, candidate.b);
        if (exact.touching()) return;  // touching pairs are no candidates
        const FilteredNearest quick(candidate.a, candidate.b);
        candidate.lower = quick.lower();
        if (quick.upper() < upper) upper = quick.upper(), closest = &candidate;
        const int order = expected ? compare(exact, expected->least) : -1;
        if (order < 0 || (order == 0 && candidate.triangles < expected->triangles))
            expected = {std::move(exact), candidate.triangles};
    }
    const NearestCandidate copy = *closest;
    std::int64_t rational = 0;
    const LeastDistance least = decide_nearest(candidates, copy, upper, radius, rational);
    ASSERT_EQ(least.within, expected->least.within(radius < infinity ? radius : 0x1p1000));
    ASSERT_EQ(least.squared, expected->least.squared());
    ASSERT_EQ(least.triangles, expected->triangles);
    ASSERT_EQ(least.points[0], expected->least.points()[0]);
    ASSERT_EQ(least.points[1], expected->least.points()[1]);
}

TEST(DecidedNearest, agrees_with_rational_arithmetic) {
    for_triangles(300, [](RandomTriangles& random, double) {
        Array<NearestCandidate> candidates;
        // Few points, so that distances tie. The order of candidates is not that of their triangles.
        const TrianglePoints a[]{random(0), random(0)}, b[]{random(7), random(7)};
        for (std::int32_t i = 5; i >= 0; --i) {
            const auto pick = [&](const TrianglePoints* from) {
                const auto point = [&] { return from[random.below(2)][static_cast<std::size_t>(random.below(3))]; };
                return TrianglePoints{point(), point(), point()};
            };
            candidates.push_back({{i / 3, i}, pick(a), pick(b), 0});
        }
        compare_with_rational(candidates, random.below(2) ? infinity : 5.0);
    });
}

}  // namespace
}  // namespace crumple::test
