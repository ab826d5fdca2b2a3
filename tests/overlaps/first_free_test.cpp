// Tests of the first motion along a direction at which two bodies do not overlap, against brute force and by cases
// whose result is evident.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "backends/reference/reference_first_free.h"
#include "exact/withdrawal/sheared_face.h"
#include "overlaps/closed_bodies.h"
#include "overlaps/placed_soups.h"
#include "overlaps/random_triangles.h"
#include "rounds.h"
#include "search/withdrawal/first_free_search.h"
#include "search/withdrawal/withdrawal_search.h"

namespace crumple::test {
namespace {

double first_free(const Placed& a, const Placed& b, const Vec3d& d, FirstFreeCounts& counts) {
    Cancellation none;
    ParallelFor serial;
    MemoryMeter meter;
    const double t = find_first_free(a.surface, b.surface, d, serial, none, meter, counts);
    EXPECT_EQ(meter.used, 0);
    WithdrawalCounts of_withdrawal;
    EXPECT_LE(t, find_withdrawal(a.surface, b.surface, d, serial, none, of_withdrawal));
    return t;
}

double first_free(const Placed& a, const Placed& b, const Vec3d& d) {
    FirstFreeCounts counts;
    return first_free(a, b, d, counts);
}

PosedBody posed(const Placed& of) {
    PosedBody body;
    body.point = of.points;
    for (std::int32_t f = 0; f < of.closed.face_count(); ++f) {
        const std::int32_t* c = of.closed.corners(f);
        body.face.push_back({c[0], c[1], c[2]});
    }
    return body;
}

double by_brute_force(const Placed& a, const Placed& b, const Vec3d& d) {
    Cancellation none;
    return first_free_by_brute_force(posed(a), posed(b), d, none);
}

Soup<double> box(const Vec3d& low, const Vec3d& high) {
    Dice dice(1);
    Soup<double> soup;
    add_box(dice, true, 1, soup);
    for (std::size_t v = 0; v < 8; ++v)
        for (std::size_t k = 0; k < 3; ++k) soup.vertices[v][k] = (v >> k & 1 ? high : low)[static_cast<int>(k)];
    return soup;
}

/// Turns a body inside out.
Soup<double> inverted(Soup<double> soup) {
    for (auto& triangle : soup.triangles) std::swap(triangle[0], triangle[1]);
    return soup;
}

/// Returns t of the search, and expects that of brute force to be the same.
double agreed(const Soup<double>& a, const Soup<double>& b, const Vec3d& d) {
    const Placed p(a), q(b);
    const double t = first_free(p, q, d);
    EXPECT_EQ(t, by_brute_force(p, q, d));
    return t;
}

TEST(FirstFree, equals_brute_force_for_closed_bodies) {
    FirstFreeCounts counts;
    int positive = 0;
    const int rounds = std::max(20, scaled_rounds(20));
    for (int round = 0; round < rounds; ++round) {
        Dice dice(static_cast<unsigned>(round));
        const bool grid = dice.chance(0.7);
        ClosedBodies bodies = closed_bodies(static_cast<unsigned>(round), 2, grid, false);
        if (dice.chance(0.2)) add_t_junction(bodies.soups[0]);
        if (dice.chance(0.3)) bodies.soups[1] = joined(bodies.soups[1], inverted(bodies.soups[0]));
        const Placed a(bodies.soups[0]), b(bodies.soups[1]);
        for (int k = 0; k < 2; ++k) {
            const Vec3d d = random_direction(dice, a.surface.corners(dice.below(a.closed.face_count())), grid);
            const double t = first_free(a, b, d, counts);
            ASSERT_EQ(t, by_brute_force(a, b, d)) << round << ' ' << k;
            positive += t > 0;
        }
    }
    EXPECT_GT(positive, rounds / 2);
    EXPECT_GT(counts.samples, 0);
    EXPECT_GT(counts.pairs, 0);
    EXPECT_GT(counts.contacts, 0);
}

/// Returns a prism along y over a polygon of the plane of x and z, which may cross itself.
Soup<double> prism(const std::array<std::array<double, 2>, 4>& polygon, double low, double high) {
    Soup<double> soup;
    for (const double y : {low, high})
        for (const auto& [x, z] : polygon) soup.vertices.push_back({x, y, z});
    for (std::int32_t k = 0; k < 4; ++k) {
        const std::int32_t next = (k + 1) % 4;
        soup.triangles.push_back({k, next, next + 4});
        soup.triangles.push_back({k, next + 4, k + 4});
    }
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, std::array{0, 3, 2}}) {
        soup.triangles.push_back({a, b, c});
        soup.triangles.push_back({c + 4, b + 4, a + 4});
    }
    return soup;
}

TEST(FirstFree, first_gap_of_a_comb_counts) {
    const auto slabs = [](double low) { return joined(box({0, 0, 0}, {4, 4, 1}), box({0, 0, low}, {4, 4, low + 1})); };
    const Soup<double> peg = box({1, 1, 0.5}, {2, 2, 1.5});
    EXPECT_EQ(agreed(slabs(5), peg, {0, 0, 1}), 0.5);
    EXPECT_EQ(agreed(slabs(5), peg, {0, 0, 0.25}), 2);
    EXPECT_EQ(agreed(slabs(2), peg, {0, 0, 1}), 0.5);  // it fits the gap exactly
    EXPECT_EQ(agreed(slabs(1.9), peg, {0, 0, 1}), 1.9 + 1 - 0.5);
    EXPECT_EQ(agreed(slabs(1.9), peg, {0, 0, -1}), 1.5);
    EXPECT_EQ(agreed(slabs(1.9), peg, {2, 0, 0}), 1.5);
    const Placed a(slabs(5)), b(peg);
    Cancellation none;
    ParallelFor serial;
    WithdrawalCounts counts;
    EXPECT_EQ(find_withdrawal(a.surface, b.surface, {0, 0, 1}, serial, none, counts), 5.5);
}

TEST(FirstFree, equal_boxes_separate_by_their_width) {
    const Soup<double> one = box({0, 0, 0}, {1, 2, 1});
    EXPECT_EQ(agreed(one, one, {0, 0, 1}), 1);
    EXPECT_EQ(agreed(one, one, {0, -0.5, 0}), 4);
    EXPECT_EQ(agreed(one, one, {1, 1, 1}), 1);
    EXPECT_EQ(agreed(one, inverted(one), {1, 1, 1}), 1);
}

TEST(FirstFree, is_0_if_bodies_only_touch) {
    const Soup<double> one = box({0, 0, 0}, {1, 1, 1});
    for (const Vec3d& low : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{1, 1, 0}, Vec3d{1, 1, 1}, Vec3d{0.5, 0.25, 1}})
        for (const Vec3d& d : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{-1, -2, -3}})
            EXPECT_EQ(agreed(one, box(low, low + Vec3d{1, 1, 1}), d), 0);
}

TEST(FirstFree, body_in_a_shell_is_free_in_the_cavity) {
    const Soup<double> shell = joined(box({0, 0, 0}, {10, 10, 10}), inverted(box({3, 3, 3}, {7, 7, 7})));
    EXPECT_EQ(agreed(shell, box({4, 4, 4}, {5, 5, 5}), {1, 0, 0}), 0);
    EXPECT_EQ(agreed(shell, box({1, 1, 1}, {2, 2, 2}), {1, 0, 0}), 9);
    EXPECT_EQ(agreed(shell, box({1, 4, 4}, {2, 5, 5}), {1, 0, 0}), 2);
    EXPECT_EQ(agreed(shell, box({1, 4, 4}, {2, 5, 5}), {-1, 0, 0}), 2);
    EXPECT_EQ(agreed(shell, box({1, 1, 1}, {2, 2, 2}), {1, 1, 1}), 2);
    EXPECT_EQ(agreed(box({4, 4, 4}, {5, 5, 5}), shell, {1, 0, 0}), 0);
    EXPECT_EQ(agreed(box({1, 1, 1}, {2, 2, 2}), shell, {-2, 0, 0}), 4.5);
}

TEST(FirstFree, peg_that_fits_a_hole_is_free) {
    Soup<double> plate = joined(box({0, 0, 0}, {1, 4, 1}), box({2, 0, 0}, {4, 4, 1}));
    plate = joined(joined(plate, box({1, 0, 0}, {2, 1, 1})), box({1, 2, 0}, {2, 4, 1}));
    EXPECT_EQ(agreed(plate, box({1, 1, -1}, {2, 2, 0.5}), {0, 0, 1}), 0);
    EXPECT_EQ(agreed(plate, box({1, 1, -1}, {2, 2, 0.5}), {0, 0, -1}), 0);
    EXPECT_EQ(agreed(plate, box({1, 1, -1}, {2 + 0x1p-40, 2, 0.5}), {0, 0, 1}), 2);
    EXPECT_EQ(agreed(plate, box({1, 1, -1}, {2 + 0x1p-40, 2, 0.5}), {0, 0, -2}), 0.25);
    EXPECT_EQ(agreed(plate, box({1, 1, -1}, {2 + 0x1p-40, 2, 0.5}), {-1, 0, 0}), 2 + 0x1p-40);
    EXPECT_EQ(agreed(plate, box({1 - 0x1p-40, 1, -1}, {2 - 0x1p-40, 2, 0.5}), {1, 0, 0}), 0x1p-40);
}

TEST(FirstFree, two_boxes_in_two_slots_are_free_together) {
    const auto walls = [](double first, double second) {
        return joined(box({0, 0, 0}, {first, 1, 4}), box({first + 1, 0, 0}, {second, 1, 4}));
    };
    const Soup<double> fork = joined(box({1, 0.25, 1}, {2, 0.75, 5}), box({5, 0.25, 1}, {6, 0.75, 5}));
    EXPECT_EQ(agreed(walls(1, 5), fork, {1, 0, 0}), 0);
    EXPECT_EQ(agreed(walls(1.5, 5.5), fork, {1, 0, 0}), 0.5);
    EXPECT_EQ(agreed(walls(1.5, 5.5), fork, {0, 0, 1}), 3);
}

TEST(FirstFree, volumes_that_cancel_are_not_free) {
    const Soup<double> both = joined(box({0, 0, 0}, {1, 1, 1}), inverted(box({2, 0, 0}, {3, 1, 1})));
    EXPECT_EQ(agreed(both, box({0, 0, 0.5}, {3, 1, 2}), {0, 0, 1}), 0.5);
}

TEST(FirstFree, bodies_that_pass_through_themselves_may_be_free_for_an_instant) {
    // Each is two wedges with opposite windings that meet at a line. The lines coincide at t = 0.5.
    const Soup<double> wide = prism({{{-2, -1}, {2, 1}, {2, -1}, {-2, 1}}}, 0, 4);
    const Soup<double> narrow = prism({{{-1, -2.5}, {1, 1.5}, {-1, 1.5}, {1, -2.5}}}, 1, 3);
    EXPECT_EQ(agreed(wide, narrow, {0, 0, 1}), 0.5);
    EXPECT_EQ(agreed(wide, narrow, {0, 0, -1}), 2);
}

TEST(FirstFree, search_ends_if_places_of_contact_converge) {
    Soup<double> a, b;
    a.vertices = {{1, 2, 1}, {2, 1, 3}, {3, 3, 3}, {3, 0, 2}, {3, 1, 3},
                  {1, 0, 2}, {3, 2, 3}, {3, 3, 1}, {3, 3, 3}, {0, 1, 1}};
    a.triangles = {{0, 1, 3}, {1, 0, 4}, {1, 2, 3}, {2, 1, 4}, {2, 0, 3}, {0, 2, 4},
                   {5, 6, 8}, {6, 5, 9}, {6, 7, 8}, {7, 6, 9}, {7, 5, 8}, {5, 7, 9}};
    b.vertices = {{2, 3, 2}, {4, 0, 4}, {2, 2, 1}, {1, 3, 4}};
    b.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    EXPECT_GT(agreed(a, b, {1, 2, 0}), 0);
}

TEST(FirstFree, memory_meter_counts_cached_faces_and_their_numbers) {
    const Placed a(box({0, 0, 0}, {1, 1, 1})), b(box({0.25, 0.25, 0.25}, {1.25, 1.25, 1.25}));
    Cancellation none;
    ParallelFor serial;
    FirstFreeCounts counts;
    MemoryMeter unlimited, limited;
    EXPECT_EQ(find_first_free(a.surface, b.surface, {0, 0, 1}, serial, none, unlimited, counts), 0.75);
    EXPECT_EQ(unlimited.used, 0);
    const auto faces = static_cast<std::int64_t>(24 * sizeof(ShearedFace));
    EXPECT_GT(unlimited.peak, faces);
    EXPECT_LT(unlimited.peak, 10 * faces);
    limited.limit = unlimited.peak - 1;
    EXPECT_THROW(find_first_free(a.surface, b.surface, {0, 0, 1}, serial, none, limited, counts),
                 MemoryMeter::Exceeded);
    EXPECT_EQ(limited.used, 0);
}

TEST(FirstFree, numbers_of_any_size_are_exact) {
    for (const double factor : {1e-120, 1e120, 0x1p-1060, 0x1p1000}) {
        const Soup<double> slabs = scaled(joined(box({0, 0, 0}, {4, 4, 1}), box({0, 0, 5}, {4, 4, 6})), factor);
        EXPECT_EQ(agreed(slabs, scaled(box({1, 1, 0.5}, {2, 2, 1.5}), factor), {0, 0, 1}), 0.5 * factor);
    }
    const Soup<double> one = box({0, 0, 0}, {1, 1, 1});
    EXPECT_EQ(agreed(one, one, {0, 0, 0x1p-1074}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(agreed(one, one, {0, 0, 0x1p1000}), 0x1p-1000);
    EXPECT_EQ(agreed(one, one, {0, 0, 3}), std::nextafter(1.0 / 3, 1));  // rounded up
}

}  // namespace
}  // namespace crumple::test
