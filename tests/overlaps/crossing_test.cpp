// Compares crossings of two faces in double-double arithmetic, signs and numbers, with rational arithmetic. Ties are
// decided as if the second face were shifted by an infinitesimal vector (Shift::forward) or its opposite.

#include <gtest/gtest.h>

#include "base/float_environment.h"
#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/filtered_crossing.h"
#include "exact/overlap/packed_crossings.h"
#include "exact/overlap/rounded_parameter.h"
#include "geometry/random_pairs.h"

namespace crumple {
namespace {

bool in_range(const Triangle& t) {
    for (const Vec3d& p : t.point)
        for (int axis = 0; axis < 3; ++axis)
            if (p[axis] != 0 && !(std::abs(p[axis]) >= 0x1p-150 && std::abs(p[axis]) <= 0x1p150)) return false;
    return true;
}

RationalCrossing truth(const TrianglePair& pair, Shift shift) {
    const int unit = common_exponent(std::array{pair.a.point[0], pair.a.point[1], pair.a.point[2], pair.b.point[0],
                                                pair.b.point[1], pair.b.point[2]});
    return cross_rationally(in_units(pair.a.point, unit), in_units(pair.b.point, unit), shift);
}

bool encloses(const Enclosed& x, const Rational& exact) {
    if (!std::isfinite(x.error)) return true;
    return abs(Rational(x.value.high) + Rational(x.value.low) - exact) <= Rational(x.error);
}

class CrossingOfEachKind : public testing::TestWithParam<Kind> {
   protected:
    RandomPairs random{GetParam(), 23};
    int rounds() const { return rounds_of(GetParam(), 4'000); }
    /// True for kinds with segments of which double words can compute the ends.
    static bool has_segments() {
        const bool has_range = GetParam() != Kind::huge && GetParam() != Kind::tiny && GetParam() != Kind::mixed;
        return has_range && GetParam() < Kind::collapsed;
    }
};

TEST_P(CrossingOfEachKind, signs_are_exact_and_error_bounds_hold_in_the_filters_range) {
    const FloatEnvironment environment;
    int segments = 0, bounded = 0;
    for (int round = 0; round < rounds(); ++round) {
        const TrianglePair pair = random();
        if (!in_range(pair.a) || !in_range(pair.b)) continue;
        for (const Shift shift : {Shift::forward, Shift::backward}) {
            const RationalCrossing exact = truth(pair, shift);
            const FilteredCrossing quick = filter_crossing(CrossedFace(pair.a.point), CrossedFace(pair.b.point), shift);
            ASSERT_EQ(quick.jumps.a, exact.jumps.a) << pair;
            ASSERT_EQ(quick.jumps.b, exact.jumps.b) << pair;
            ASSERT_EQ(quick.jumps.segment, exact.jumps.segment) << pair;
            if (!exact.jumps.segment) continue;
            ++segments;
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_TRUE(encloses(quick.a[k], exact.a[k])) << pair;
                EXPECT_TRUE(encloses(quick.b[k], exact.b[k])) << pair;
            }
            const auto expect_enclosed = [&](const PointInFace<Enclosed>& point,
                                             const PointInFace<Rational>& true_point) {
                EXPECT_TRUE(encloses(point.u, true_point.u)) << pair;
                EXPECT_TRUE(encloses(point.v, true_point.v)) << pair;
                bounded += std::isfinite(point.u.error) && std::isfinite(point.v.error);
            };
            expect_enclosed(quick.start_in_a, exact.start_in_a);
            expect_enclosed(quick.end_in_a, exact.end_in_a);
            expect_enclosed(quick.start_in_b, exact.start_in_b);
            expect_enclosed(quick.end_in_b, exact.end_in_b);
        }
    }
    if (has_segments()) {
        EXPECT_GT(segments, 0);
        EXPECT_GT(bounded, 0);
    }
}

TEST_P(CrossingOfEachKind, untied_pairs_cross_alike_under_both_shifts) {
    const FloatEnvironment environment;
    int untied = 0;
    for (int round = 0; round < rounds() / 4; ++round) {
        const TrianglePair pair = random();
        if (!in_range(pair.a) || !in_range(pair.b)) continue;
        const CrossedFace a(pair.a.point), b(pair.b.point);
        const FilteredCrossing one = filter_crossing(a, b, Shift::forward),
                               other = filter_crossing(a, b, Shift::backward);
        EXPECT_EQ(one.tied, other.tied) << pair;
        if (one.tied) continue;
        EXPECT_EQ(one.jumps.a, other.jumps.a) << pair;
        EXPECT_EQ(one.jumps.b, other.jumps.b) << pair;
        EXPECT_EQ(one.jumps.segment, other.jumps.segment) << pair;
        ++untied;
    }
    if (GetParam() == Kind::random) {
        EXPECT_GT(untied, 0);
    }
}

// Only the second face is shifted. If a and b are exchanged, the other face is shifted; the opposite shift then gives
// the same relative position.
TEST_P(CrossingOfEachKind, exchanged_faces_cross_alike) {
    const FloatEnvironment environment;
    for (int round = 0; round < rounds() / 8; ++round) {
        const TrianglePair pair = random();
        const RationalCrossing one = truth(pair, Shift::forward), other = truth({pair.b, pair.a}, Shift::backward);
        EXPECT_EQ(one.jumps.a, other.jumps.b) << pair;
        EXPECT_EQ(one.jumps.b, other.jumps.a) << pair;
        EXPECT_EQ(one.a, other.b) << pair;
        EXPECT_EQ(one.b, other.a) << pair;
    }
}

TEST_P(CrossingOfEachKind, rounded_parameters_and_points_are_within_their_error_bounds) {
    const FloatEnvironment environment;
    int bounded = 0;
    for (int round = 0; round < rounds(); ++round) {
        const TrianglePair pair = random();
        if (!in_range(pair.a) || !in_range(pair.b)) continue;
        const auto& p = pair.a.point;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d &from = p[k], &to = p[next_corner(k)];
            const RoundedParameter t = rounded_parameter(from, to, pair.b.point);
            if (!std::isfinite(t.error)) continue;
            ++bounded;
            const Rational exact = edge_parameter(from, to, pair.b.point);
            ASSERT_LE(abs(Rational(t.value) - exact), Rational(t.error)) << pair;
            for (int axis = 0; axis < 3; ++axis) {
                const auto x = RoundedNumber::between(from[axis], to[axis], t);
                const Rational point = Rational(from[axis]) + exact * (Rational(to[axis]) - Rational(from[axis]));
                ASSERT_LE(abs(Rational(x.value) - point), Rational(x.error)) << pair;
            }
        }
    }
    if (has_segments()) {
        EXPECT_GT(bounded, 0);
    }
}

TEST_P(CrossingOfEachKind, packed_crossings_keep_everything) {
    const FloatEnvironment environment;
    int segments = 0;
    const auto expect_same = [&](const DecidedCrossing& x, const DecidedCrossing& y) {
        EXPECT_EQ(x.jumps.a, y.jumps.a);
        EXPECT_EQ(x.jumps.b, y.jumps.b);
        ASSERT_EQ(x.jumps.segment, y.jumps.segment);
        if (!x.jumps.segment) return;
        ++segments;
        for (const auto end : {&Segment::start, &Segment::end}) {
            const SegmentEnd &p = x.segment.*end, &q = y.segment.*end;
            EXPECT_EQ(p.side, q.side);
            EXPECT_EQ(p.edge, q.edge);
            EXPECT_EQ(p.vertex, q.vertex);
            EXPECT_EQ(p.jump, q.jump);
        }
    };
    for (int round = 0; round < rounds(); ++round) {
        const TrianglePair pair = random();
        if (!in_range(pair.a) || !in_range(pair.b)) continue;
        const CrossedFace a(pair.a.point), b(pair.b.point);
        FilteredCrossingSigns signs(a, b);
        const DecidedCrossings both = decide_crossings(signs);
        PackedCrossings packed = PackedCrossings::pack(both);
        EXPECT_FALSE(packed.uncertain());
        packed.set_uncertain();
        EXPECT_TRUE(packed.uncertain());
        const DecidedCrossings found = packed.unpack();
        expect_same(found.forward, both.forward);
        expect_same(found.backward, both.backward);
        EXPECT_EQ(found.tied, both.tied) << pair;
        EXPECT_EQ(found.coplanar, both.coplanar) << pair;
    }
    if (has_segments()) {
        EXPECT_GT(segments, 0);
    }
}

INSTANTIATE_TEST_SUITE_P(All, CrossingOfEachKind, testing::ValuesIn(all_kinds));

TEST(Crossing, weights_are_integrals_over_the_corner_that_is_cut_off) {
    // The plane x = 1/2 with its outside towards larger x cuts the corner (1, 0, 0) off: inside is what has x < 1/2.
    const CrossedFace a({Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}),
        b({Vec3d{0.5, -4, -4}, {0.5, 4, -4}, {0.5, 0, 8}});
    const FilteredCrossing crossing = filter_crossing(a, b, Shift::forward);
    ASSERT_TRUE(crossing.jumps.segment);
    EXPECT_EQ(crossing.jumps.a, (EdgeJumps{-1, 1, 0}));
    double sum = 0;
    for (const Enclosed& weight : crossing.a) sum += weight.value.high;
    EXPECT_EQ(sum, -3 * 0.25);  // a quarter of the face has a winding number that is less by 1
    EXPECT_EQ(crossing.a[1].value.high, -(0.25 * (1 + 0.5 + 0.5)));
}

}  // namespace
}  // namespace crumple
