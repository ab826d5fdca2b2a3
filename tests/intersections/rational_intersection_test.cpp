#include "exact/intersection/exact_intersection.h"

#include <gtest/gtest.h>

#include <limits>

#include "intersections/named_pairs.h"

namespace crumple {
namespace {

std::vector<Vec3d> points_of(const Contact& c) { return {c.points.begin(), c.points.begin() + c.count}; }

TEST(RationalIntersection, handmade_pairs_intersect_as_expected) {
    for (const NamedPair& named : named_pairs()) {
        SCOPED_TRACE(testing::Message() << named.claim << ": " << named.pair);
        const RationalIntersection found = intersect_rationally(named.pair.a, named.pair.b);
        EXPECT_EQ(found.collides, named.collides);
        EXPECT_EQ(found.proper, named.proper);
        EXPECT_EQ(found.shared, named.shared);
        EXPECT_EQ(points_of(contact(found)), named.points);
        EXPECT_EQ(collide(found, Neighbours::geometric, IntersectionKind::all), named.collides);
        EXPECT_EQ(collide(found, Neighbours::geometric, IntersectionKind::proper), named.proper);
        EXPECT_EQ(collide(found, Neighbours::skip, IntersectionKind::all), named.collides && named.shared == 0);
    }
}

TEST(RationalIntersection, scales_by_powers_of_two_without_loss) {
    // The named pairs are on a grid of at most 9 units: from the smallest subnormal to the largest powers.
    for (const double unit : {0x1p-1074, 0x1p-1022, 0x1p-300, 0x1p1020}) {
        for (NamedPair named : named_pairs()) {
            for (Vec3d& p : named.pair.a.point) p = unit * p;
            for (Vec3d& p : named.pair.b.point) p = unit * p;
            for (Vec3d& p : named.points) p = unit * p;
            const RationalIntersection found = intersect_rationally(named.pair.a, named.pair.b);
            EXPECT_EQ(found.collides, named.collides) << named.claim << " at " << unit;
            EXPECT_EQ(found.proper, named.proper) << named.claim << " at " << unit;
            EXPECT_EQ(points_of(contact(found)), named.points) << named.claim << " at " << unit;
        }
    }
}

TEST(RationalIntersection, does_not_depend_on_the_order_of_triangles_and_corners) {
    for (const Kind kind : {Kind::lattice, Kind::flat, Kind::random, Kind::mixed}) {
        RandomPairs random(kind, 17);
        for (int i = 0; i < (kind == Kind::mixed ? 60 : 1'000); ++i) {
            const auto [a, b] = random();
            const Triangle turned{{a.point[1], a.point[2], a.point[0]}, {a.vertex[1], a.vertex[2], a.vertex[0]}};
            const Triangle mirrored{{b.point[0], b.point[2], b.point[1]}, {b.vertex[0], b.vertex[2], b.vertex[1]}};
            const RationalIntersection one = intersect_rationally(a, b), two = intersect_rationally(mirrored, turned);
            ASSERT_EQ(one.collides, two.collides) << TrianglePair{a, b};
            ASSERT_EQ(one.proper, two.proper) << TrianglePair{a, b};
            ASSERT_EQ(one.shared, two.shared) << TrianglePair{a, b};
            // The points of an area may be in the opposite order.
            std::vector<Vec3d> p = points_of(contact(one)), q = points_of(contact(two));
            const auto less = [](const Vec3d& s, const Vec3d& t) {
                return std::array{s.x, s.y, s.z} < std::array{t.x, t.y, t.z};
            };
            std::sort(p.begin(), p.end(), less);
            std::sort(q.begin(), q.end(), less);
            ASSERT_EQ(p, q) << TrianglePair{a, b};
        }
    }
}

// Extreme points must lie in the planes of both triangles, and on the inner side of each edge.
TEST(RationalIntersection, points_lie_in_both_triangles) {
    RandomPairs random(Kind::lattice, 19);
    for (int i = 0; i < 2'000; ++i) {
        const auto [a, b] = random();
        const RationalIntersection found = intersect_rationally(a, b);
        for (const RationalPoint& p : found.points) {
            for (const Triangle& t : {a, b}) {
                Vec3<Integer> corner[3];
                for (int k = 0; k < 3; ++k) {
                    for (int axis = 0; axis < 3; ++axis) {
                        const double x = std::ldexp(t.point[static_cast<std::size_t>(k)][axis], -found.exponent);
                        corner[k][axis] = Integer(static_cast<std::int64_t>(x));
                    }
                }
                const Vec3<Integer> normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
                ASSERT_EQ(dot(normal, p.xyz - p.w * corner[0]), 0) << TrianglePair{a, b};
                for (int k = 0; k < 3; ++k) {
                    const Vec3<Integer> inwards = cross(normal, corner[(k + 1) % 3] - corner[k]);
                    ASSERT_GE(dot(inwards, p.xyz - p.w * corner[k]), 0) << TrianglePair{a, b};
                }
            }
        }
    }
}

TEST(RoundedQuotient, rounds_like_division_in_hardware) {
    std::mt19937_64 engine(23);
    const auto bits = [&](int count) { return static_cast<std::int64_t>(engine() >> (64 - count)) | 1; };
    for (int i = 0; i < 100'000; ++i) {
        const std::int64_t p = bits(1 + i % 53), q = bits(1 + (i / 53) % 53);
        const int exponent = static_cast<int>(engine() % 2'200) - 1'100 - 26;
        // Both are float64 numbers, so one division rounds correctly, to subnormals too.
        const int numerator_exponent = std::max(exponent, -1'074);
        const double numerator = std::ldexp(static_cast<double>(p), numerator_exponent);
        const double denominator = std::ldexp(static_cast<double>(q), numerator_exponent - exponent);
        const double expected = numerator / denominator;
        if (!std::isfinite(expected) || !std::isfinite(numerator)) continue;
        ASSERT_EQ(round_quotient(Integer(p), Integer(q), exponent), expected) << p << " / " << q << " 2^" << exponent;
        ASSERT_EQ(round_quotient(Integer(-p), Integer(q), exponent), -expected) << p << " / " << q << " 2^" << exponent;
    }
}

TEST(RoundedQuotient, ties_go_to_even) {
    const Integer one = 1;
    const Integer large = one << 53;
    EXPECT_EQ(round_quotient(large + 1, 1, 0), 0x1p53);
    EXPECT_EQ(round_quotient(large + 3, 1, 0), 0x1p53 + 4);
    EXPECT_EQ(round_quotient((large + 1) * 1'000'000'007 + 1, 1'000'000'007, 0), 0x1p53 + 2);
    EXPECT_EQ(round_quotient(1, 1, -1'075), 0.0);
    EXPECT_EQ(round_quotient(3, 1, -1'075), 0x1p-1073);
    EXPECT_EQ(round_quotient(large - 1, 1, 970), std::ldexp(0x1p53 - 1, 970));
    EXPECT_EQ(round_quotient(large - 1, 1, 971), std::numeric_limits<double>::max());
    EXPECT_EQ(round_quotient((large - 1) * 4 + 1, 4, 971), std::numeric_limits<double>::max());
}

TEST(RoundedQuotient, zero_is_positive) {
    EXPECT_FALSE(std::signbit(round_quotient(0, 7, 0)));
    EXPECT_FALSE(std::signbit(round_quotient(-1, 7, -1'074)));
}

TEST(LinePlaneCrossing, crossing_is_the_rounded_common_point_of_line_and_plane) {
    const std::array<Vec3d, 3> plane{Vec3d{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    EXPECT_EQ(round_crossing({1, 2, 0}, {1, 2, 3}, plane), (Vec3d{1, 2, 1}));
    EXPECT_EQ(round_crossing({0, 0, 0}, {3, 3, 3}, plane), (Vec3d{1, 1, 1}));
    EXPECT_EQ(round_crossing({0, 0, 0}, {1, 1, 3}, plane), (Vec3d{1.0 / 3, 1.0 / 3, 1}));
}

}  // namespace
}  // namespace crumple
