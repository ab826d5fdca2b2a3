// Tests of withdrawals of surfaces along a direction against brute force in rationals, and of the bound on
// translations.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "error_of.h"
#include "exact/withdrawal/exact_withdrawal.h"
#include "exact/withdrawal/filtered_withdrawal.h"
#include "exact/withdrawal/translation_bound.h"
#include "overlaps/closed_bodies.h"
#include "overlaps/random_triangles.h"
#include "rounds.h"
#include "scene/prepared_scene.h"
#include "search/withdrawal/withdrawal_search.h"

namespace crumple::test {
namespace {

/// Owner of a placed surface.
struct Placed {
    Soup<double> soup;
    std::vector<Vec3d> points;
    ClosedSurface closed{nullptr};
    PlacedSurface surface;

    explicit Placed(Soup<double> given) : soup(std::move(given)) {
        ParallelFor workers;
        SceneBuffers buffers;
        closed.prepare(prepare_scene(soup.view(), nullptr, false, workers, buffers), workers);
        surface.surface = &closed;
        for (const auto& p : soup.vertices) {
            points.push_back({p[0], p[1], p[2]});
            surface.box.widen(points.back());
            surface.in_range &= in_double_word_range(points.back());
        }
        surface.points = points.data();
        surface.vertex_count = static_cast<std::int64_t>(points.size());
    }
};

/// Runs the tasks in the opposite order.
struct Backwards final : ParallelFor {
    void parallel_for(std::size_t n, Task task) override {
        while (n > 0) task(--n);
    }
};

double withdrawal(const Placed& a, const Placed& b, const Vec3d& d) {
    Cancellation none;
    ParallelFor serial;
    Backwards backwards;
    WithdrawalCounts counts, other_counts;
    const double t = find_withdrawal(a.surface, b.surface, d, serial, none, counts);
    EXPECT_EQ(t, find_withdrawal(a.surface, b.surface, d, backwards, none, other_counts));
    EXPECT_EQ(counts.rational_tests, other_counts.rational_tests);
    return t;
}

double withdrawal_by_brute_force(const Placed& a, const Placed& b, const Vec3d& d) {
    Rational greatest = 0;
    for (std::int32_t i = 0; i < a.closed.face_count(); ++i)
        for (std::int32_t j = 0; j < b.closed.face_count(); ++j)
            if (const auto t = withdrawal_rationally(a.surface.corners(i), b.surface.corners(j), d))
                if (*t > greatest) greatest = *t;
    return rounded_up(greatest);
}

/// Returns the soup with coordinates scaled, shifted along z, and permuted cyclically.
Soup<double> changed(Soup<double> soup, double factor, double shift, std::size_t turn) {
    for (auto& p : soup.vertices) {
        const std::array<double, 3> old{factor * p[0], factor * p[1], factor * (p[2] + shift)};
        for (std::size_t k = 0; k < 3; ++k) p[(k + turn) % 3] = old[k];
    }
    return soup;
}

TEST(Withdrawal, equals_brute_force_for_closed_bodies) {
    int zero = 0;
    const int rounds = scaled_rounds(150);
    for (int round = 0; round < rounds; ++round) {
        Dice dice(static_cast<unsigned>(round));
        const bool grid = dice.chance(0.6);
        ClosedBodies bodies = closed_bodies(static_cast<unsigned>(round), 2, grid, false);
        if (dice.chance(0.3)) add_t_junction(bodies.soups[0]);
        const double factor =
            std::array{1.0, 1.0, 1.0, 1e-120, 1e120, 0x1p-1060}[static_cast<std::size_t>(dice.below(6))];
        const double shift = dice.below(9) - 4;  // some bodies only touch, or their projections do
        const auto turn = static_cast<std::size_t>(dice.below(3));
        const Placed a(changed(bodies.soups[0], factor, 0, turn)), b(changed(bodies.soups[1], factor, shift, turn));
        for (int k = 0; k < 3; ++k) {
            const auto& of = k == 0 ? a : b;
            Vec3d d = random_direction(dice, of.surface.corners(dice.below(of.closed.face_count())), grid);
            if (factor != 0x1p-1060 && dice.chance(0.2)) d = 0x1p-10 * d;
            const double t = withdrawal(a, b, d);
            ASSERT_EQ(t, withdrawal_by_brute_force(a, b, d)) << round << ' ' << k;
            zero += t == 0;
        }
    }
    EXPECT_GT(zero, rounds / 2);
    EXPECT_LT(zero, 2 * rounds);
}

TEST(Withdrawal, equals_brute_force_for_soups_of_any_triangles) {
    for (unsigned round = 0; round < (thorough() ? 12u : 5u); ++round) {
        Dice dice(round);
        Placed a(random_soup<double>(60, 0.4, round)), b(random_soup<double>(60, 0.4, round + 100));
        for (int k = 0; k < 20; ++k) {  // degenerate triangles
            const auto of = static_cast<std::size_t>(3 * dice.below(60));
            a.points[of] = a.points[of + 1];
            b.points[of] = 0.25 * b.points[of + 1] + 0.75 * b.points[of + 2];
        }
        for (int k = 0; k < 3; ++k) {
            const Vec3d d = random_direction(dice, a.surface.corners(dice.below(60)), false);
            ASSERT_EQ(withdrawal(a, b, d), withdrawal_by_brute_force(a, b, d)) << round;
        }
    }
}

TEST(Withdrawal, of_large_surfaces_is_attained_by_a_pair_and_exceeded_by_none) {
    for (unsigned round = 0; round < (thorough() ? 4u : 2u); ++round) {
        Dice dice(round);
        Soup<double> many = random_soup<double>(1500, 0.05, round), few = random_soup<double>(150, 0.1, round + 100);
        const bool flat = round % 2 != 0;  // parallel to the direction
        const Vec3d d = flat ? Vec3d{1, 0, 0} : point_between(dice, -1, 1);
        for (Soup<double>* soup : {&many, &few})
            for (auto& p : soup->vertices)
                if (flat) p[2] = 0.25 * std::round(8 * p[1]) / 8, p[1] = std::round(8 * p[1]) / 8;
        const Placed a(many), b(few);
        const double t = withdrawal(a, b, d);
        EXPECT_GT(t, 0);
        bool is_attained = false;
        for (std::int32_t i = 0; i < 1500; ++i)
            for (std::int32_t j = 0; j < 150; ++j) {
                const FaceCorners p = a.surface.corners(i), q = b.surface.corners(j);
                if (enclose_withdrawal(p, q, d, 0).upper < t) continue;
                const auto exact = withdrawal_rationally(p, q, d);
                const double rounded = exact && *exact >= 0 ? rounded_up(*exact) : 0;
                ASSERT_LE(rounded, t) << round;
                is_attained |= rounded == t;
            }
        EXPECT_TRUE(is_attained) << round;
    }
}

Soup<double> box(const Vec3d& low, const Vec3d& high) {
    Dice dice(1);
    Soup<double> soup;
    add_box(dice, true, 1, soup);
    for (std::size_t v = 0; v < 8; ++v)
        for (std::size_t k = 0; k < 3; ++k) soup.vertices[v][k] = (v >> k & 1 ? high : low)[static_cast<int>(k)];
    return soup;
}

TEST(Withdrawal, last_of_several_contacts_counts) {
    const Placed slabs(joined(box({0, 0, 0}, {4, 4, 1}), box({0, 0, 5}, {4, 4, 6}))), peg(box({1, 1, 0.5}, {2, 2, 2}));
    EXPECT_EQ(withdrawal(slabs, peg, {0, 0, 1}), 5.5);
    EXPECT_EQ(withdrawal(slabs, peg, {0, 0, -1}), 2);
    EXPECT_EQ(withdrawal(slabs, peg, {0, 0, 0.25}), 22);
    EXPECT_EQ(withdrawal(slabs, peg, {3, 0, 0}), 1);
    EXPECT_EQ(withdrawal(slabs, peg, {1, 0, 1}), 3);  // it leaves the slab at the side
}

TEST(Withdrawal, is_0_if_surfaces_do_not_meet_again) {
    const Placed a(box({0, 0, 0}, {1, 1, 1}));
    EXPECT_EQ(withdrawal(a, Placed(box({0, 0, 3}, {1, 1, 4})), {0, 0, 1}), 0);
    EXPECT_EQ(withdrawal(a, Placed(box({0, 0, 3}, {1, 1, 4})), {0, 0, -1}), 4);
    EXPECT_EQ(withdrawal(a, Placed(box({0, 0, 1}, {1, 1, 2})), {0, 0, 1}), 0);
    EXPECT_EQ(withdrawal(a, Placed(box({1, 1, 0}, {2, 2, 1})), {0, 0, 1}), 1);  // they touch along an edge
    EXPECT_EQ(withdrawal(a, Placed(box({1 + 0x1p-52, 0, 0}, {2, 1, 1})), {0, 0, 1}), 0);
    EXPECT_EQ(withdrawal(a, Placed(Soup<double>{}), {0, 0, 1}), 0);
}

TEST(Withdrawal, faces_in_contact_at_the_end_are_not_all_decided_exactly) {
    Soup<double> low, high;  // two grids of triangles that coincide at the end
    for (int side = 0; side < 2; ++side) {
        Soup<double>& soup = side ? high : low;
        for (int i = 0; i < 31 * 31; ++i) {
            const double x = i % 31, y = i / 31;
            soup.vertices.push_back({x + 0.25 * side, y, side ? 0.1 * x : 7.7 + 0.1 * x});
            if (i % 31 != 30 && i / 31 != 30) {
                soup.triangles.push_back({i, i + 1, i + 31});
                soup.triangles.push_back({i + 1, i + 32, i + 31});
            }
        }
    }
    const Placed a(high), b(low);
    Cancellation none;
    ParallelFor serial;
    for (const Vec3d& d : {Vec3d{0, 0, -1}, Vec3d{1, 0, -1}, Vec3d{0.3, 0.2, -0.7}}) {
        WithdrawalCounts counts;
        const double t = find_withdrawal(a.surface, b.surface, d, serial, none, counts);
        EXPECT_GT(t, 7);
        EXPECT_LT(counts.rational_tests, 20);
    }
}

TEST(Withdrawal, errors_name_the_direction) {
    const Placed a(box({0, 0, 0}, {1, 1, 1}));
    const auto code = [&](const Vec3d& d) { return error_of([&] { withdrawal(a, a, d); }).code; };
    EXPECT_EQ(code({0, 0, 0}), ErrorCode::invalid_argument);
    EXPECT_EQ(code({0, std::nan(""), 0}), ErrorCode::invalid_argument);
    EXPECT_EQ(withdrawal(a, a, {0, 0, 0x1p-1074}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(withdrawal(a, a, {0, 0, 0x1p-1000}), 0x1p1000);
    EXPECT_EQ(withdrawal(a, a, {0, 0, 0x1p1000}), 0x1p-1000);
    const Placed low(box({0, 0, -1.6e308}, {1, 1, -1.5e308})), high(box({0, 0, 1.5e308}, {1, 1, 1.6e308}));
    EXPECT_EQ(withdrawal(high, low, {0, 0, 1}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(withdrawal(high, low, {0, 0, 2}), 1.6e308);
    EXPECT_EQ(withdrawal(low, high, {0, 0, 1}), 0);
}

double area_of(const PlacedSurface& surface) {
    ProjectedArea area;
    for (std::int32_t face = 0; face < surface.surface->face_count(); ++face) area.add(surface.corners(face));
    return area.bound();
}

TEST(TranslationBound, is_attained_for_cubes_up_to_the_factor_of_the_projection) {
    const Placed a(box({0, 0, 0}, {2, 2, 2})), b(box({0, 0, 1.5}, {2, 2, 3.5}));
    const double bound = least_translation(area_of(a.surface), area_of(b.surface), 2 * 2 * 0.5);
    EXPECT_LE(bound, 0.5 / std::sqrt(3.0));
    EXPECT_GE(bound, (1 - 1e-12) * 0.5 / std::sqrt(3.0));
    EXPECT_EQ(least_translation(area_of(a.surface), area_of(b.surface), 0), 0);
    const Placed small(changed(a.soup, 1e-80, 0, 0)), large(changed(a.soup, 1e160, 0, 0));
    EXPECT_NEAR(least_translation(area_of(small.surface), area_of(small.surface), 8e-240), 2e-80 / std::sqrt(3.0),
                1e-90);
    EXPECT_EQ(least_translation(area_of(large.surface), area_of(large.surface), 1), 0);
}

}  // namespace
}  // namespace crumple::test
