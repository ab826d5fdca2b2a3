// Tests of the withdrawal of one triangle from another: rationals against another method, and the filter against
// rationals.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "exact/withdrawal/exact_withdrawal.h"
#include "exact/withdrawal/filtered_withdrawal.h"
#include "overlaps/random_triangles.h"
#include "rounds.h"
#include "search/containment/placed_surface.h"

namespace crumple::test {
namespace {

using Point = Vec3<Rational>;

Point rational(const Vec3d& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

/// Greatest t for which t · d lies in the convex hull of points: in a vertex, an edge or a triangle of theirs that has
/// a single common point with the line through the origin along d.
class HullExit {
   public:
    HullExit(std::vector<Point> points, const Point& d) : w_(std::move(points)), d_(d) {
        for (std::size_t i = 0; i < w_.size(); ++i) {
            add_vertex(w_[i]);
            for (std::size_t j = 0; j < i; ++j) {
                add_edge(w_[i], w_[j]);
                for (std::size_t k = 0; k < j; ++k) add_triangle(w_[i], w_[j], w_[k]);
            }
        }
    }
    std::optional<Rational> greatest;

   private:
    void add(const Rational& t) {
        if (!greatest || t > *greatest) greatest = t;
    }
    // t d = p
    void add_vertex(const Point& p) {
        if (cross(p, d_) != Point{}) return;
        for (int axis = 0; axis < 3; ++axis)
            if (d_[axis] != 0) return add(p[axis] / d_[axis]);
    }
    // t d = p + s (q − p)
    void add_edge(const Point& p, const Point& q) {
        const Point normal = cross(d_, q - p);
        if (normal == Point{} || dot(normal, p) != 0) return;
        const Rational s = -dot(cross(d_, p), normal) / dot(normal, normal);
        if (s >= 0 && s <= 1) add(dot(p + s * (q - p), d_) / dot(d_, d_));
    }
    // t d in the plane of p, q, r
    void add_triangle(const Point& p, const Point& q, const Point& r) {
        const Point normal = cross(q - p, r - p);
        const Rational along = dot(normal, d_);
        if (along == 0) return;
        const Rational t = dot(normal, p) / along;
        const Point at = t * d_;
        for (const Rational& side :
             {dot(normal, cross(q - p, at - p)), dot(normal, cross(r - q, at - q)), dot(normal, cross(p - r, at - r))})
            if (side < 0) return;
        add(t);
    }

    std::vector<Point> w_;
    Point d_;
};

std::optional<Rational> withdrawal_by_hull(const FaceCorners& a, const FaceCorners& b, const Vec3d& d) {
    std::vector<Point> differences;
    for (const Vec3d& p : a)
        for (const Vec3d& q : b) differences.push_back(rational(p) - rational(q));
    return HullExit(differences, rational(d)).greatest;
}

FaceCorners scaled(const FaceCorners& p, double factor) { return {factor * p[0], factor * p[1], factor * p[2]}; }

TEST(WithdrawalOfTriangles, rationals_equal_the_exit_from_the_hull_of_differences) {
    Dice dice(1);
    int meeting = 0;
    const int rounds = std::max(120, scaled_rounds(200));
    for (int round = 0; round < rounds; ++round) {
        const bool grid = dice.chance(0.7);
        const FaceCorners a = random_triangle(dice, grid), b = random_triangle(dice, grid);
        const Vec3d d = random_direction(dice, dice.chance(0.5) ? a : b, grid);
        const std::optional<Rational> expected = withdrawal_by_hull(a, b, d), t = withdrawal_rationally(a, b, d);
        ASSERT_EQ(t, expected) << round;
        meeting += t.has_value();
        // Units: coordinates and direction are scaled independently.
        if (!t) continue;
        const auto other_units = withdrawal_rationally(scaled(a, 0x1p-300), scaled(b, 0x1p-300), 8.0 * d);
        EXPECT_EQ(*other_units * 8, *t * Rational(0x1p-300));
    }
    EXPECT_GT(meeting, rounds / 4);
    EXPECT_LT(meeting, rounds);
}

TEST(WithdrawalOfTriangles, bounds_of_the_filter_contain_the_rational) {
    Dice dice(2);
    const int rounds = scaled_rounds(20000);
    int meeting = 0, certain = 0, tight = 0, apart = 0, certainly_apart = 0;
    for (int round = 0; round < rounds; ++round) {
        const bool grid = dice.chance(0.5);
        FaceCorners a = random_triangle(dice, grid), b = random_triangle(dice, grid);
        const double scale = std::ldexp(1, dice.below(3) * 60 - 60);
        if (!grid && dice.chance(0.3)) a = scaled(a, 0.1 * scale), b = scaled(b, scale);
        Vec3d d = random_direction(dice, dice.chance(0.5) ? a : b, grid);
        for (int axis = 0; axis < 3; ++axis)
            if (!in_double_word_range({d[axis], 0, 0})) d[axis] = 0;
        if (d == Vec3d{}) continue;
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(d[k]) > std::abs(d[axis])) axis = k;
        const std::optional<Rational> t = withdrawal_rationally(a, b, d);
        const WithdrawalBounds bounds = enclose_withdrawal(a, b, d, axis);
        if (!t) {
            ASSERT_TRUE(std::isinf(bounds.lower)) << round;
            ++apart;
            certainly_apart += std::isinf(bounds.upper);
            continue;
        }
        ++meeting;
        ASSERT_TRUE(std::isfinite(bounds.upper)) << round;
        ASSERT_LE(*t, Rational(bounds.upper)) << round;
        if (!std::isfinite(bounds.lower)) continue;
        ASSERT_GE(*t, Rational(bounds.lower)) << round;
        ++certain;
        const double width = bounds.upper - bounds.lower;
        tight += width <= 0x1p-51 * std::abs(bounds.upper);
    }
    EXPECT_GT(certain, 0.9 * meeting);
    EXPECT_GT(tight, 0.7 * meeting);
    EXPECT_GT(certainly_apart, 0.8 * apart);
}

TEST(WithdrawalOfTriangles, rounding_up_gives_the_least_float64_above) {
    const Rational tiny(mp::cpp_int(1), mp::cpp_int(1) << 1200);
    EXPECT_EQ(rounded_up(0), 0);
    EXPECT_EQ(rounded_up(tiny), 0x1p-1074);
    EXPECT_EQ(rounded_up(1 + tiny), 1 + 0x1p-52);
    EXPECT_EQ(rounded_up(Rational(0.1)), 0.1);
    EXPECT_EQ(rounded_up(Rational(largest_number)), largest_number);
    EXPECT_EQ(rounded_up(Rational(largest_number) + tiny), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace crumple::test
