#include "geometry/predicates.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/float_environment.h"
#include "geometry/callers_mode.h"
#include "geometry/exact.h"
#include "geometry/random_pairs.h"

namespace crumple {
namespace {

int rational_orient2d(const Vec3d& a, const Vec3d& b, const Vec3d& c, int dropped) {
    const Vec3<Rational> p = value(a), q = value(b), r = value(c);
    return Rational(cross(q - p, r - p)[dropped]).sign();
}
int rational_orient3d(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const Vec3<Rational> p = value(a), q = value(b), r = value(c), s = value(d);
    return Rational(dot(cross(q - p, r - p), s - p)).sign();
}

std::string describe(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    std::ostringstream text;
    text << TrianglePair{{{a, b, c}, {0, 1, 2}}, {{d, d, d}, {3, 3, 3}}};
    return text.str();
}

class PredicatesOfEachKind : public testing::TestWithParam<Kind> {
   protected:
    int rounds() const {
        const bool far = GetParam() == Kind::mixed || GetParam() == Kind::huge || GetParam() == Kind::tiny;
        return scaled_rounds(far ? 300 : 5'000);
    }
    RandomPairs random{GetParam(), 11};
};

TEST_P(PredicatesOfEachKind, filters_are_right_or_undecided) {
    for (int i = 0; i < rounds(); ++i) {
        const auto [s, t] = random();
        const CallersMode caller(i);
        const FloatEnvironment ours;
        const auto& [a, b, c] = s.point;
        const Vec3d d = t.point[0];
        const int sign = orient3d_filtered(a, b, c, d);
        if (sign != undecided) {
            ASSERT_EQ(sign, rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
        }
        for (int axis = 0; axis < 3; ++axis) {
            const int turn = orient2d_filtered(a, b, c, axis);
            if (turn != undecided) {
                ASSERT_EQ(turn, rational_orient2d(a, b, c, axis)) << describe(a, b, c, d);
            }
        }
    }
}

TEST_P(PredicatesOfEachKind, expansions_are_exact_in_their_range) {
    int in_range = 0;
    for (int i = 0; i < rounds(); ++i) {
        const auto [s, t] = random();
        const CallersMode caller(i);
        const FloatEnvironment ours;
        const auto& [a, b, c] = s.point;
        const Vec3d d = t.point[0];
        if (!in_expansion_range(a) || !in_expansion_range(b) || !in_expansion_range(c) || !in_expansion_range(d))
            continue;
        ++in_range;
        ASSERT_EQ(orient3d_expansion(a, b, c, d), rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
        ASSERT_EQ(orient3d_exact(a, b, c, d), rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
        ASSERT_EQ(orient3d(a, b, c, d), rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(orient2d_expansion(a, b, c, axis), rational_orient2d(a, b, c, axis)) << describe(a, b, c, d);
            ASSERT_EQ(orient2d_exact(a, b, c, axis), rational_orient2d(a, b, c, axis)) << describe(a, b, c, d);
            ASSERT_EQ(orient2d(a, b, c, axis), rational_orient2d(a, b, c, axis)) << describe(a, b, c, d);
        }
    }
    const bool far = GetParam() == Kind::mixed || GetParam() == Kind::huge || GetParam() == Kind::tiny;
    EXPECT_TRUE(far || in_range == rounds());
}

INSTANTIATE_TEST_SUITE_P(All, PredicatesOfEachKind, testing::ValuesIn(all_kinds));

TEST(Predicates, positive_sign_means_counterclockwise) {
    const Vec3d o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    EXPECT_EQ(orient3d(o, x, y, z), 1);
    EXPECT_EQ(orient3d(o, y, x, z), -1);
    EXPECT_EQ(orient3d(o, x, y, x + y), 0);
    EXPECT_EQ(orient2d(o, y, z, 0), 1);
    EXPECT_EQ(orient2d(o, z, x, 1), 1);
    EXPECT_EQ(orient2d(o, x, y, 2), 1);
    EXPECT_EQ(FilteredPlane({o, x, y}).side(z), 1);
}

TEST(Predicates, float32_limits_are_in_expansion_range_but_float64_limits_are_not) {
    EXPECT_TRUE(in_expansion_range(0.0));
    EXPECT_TRUE(in_expansion_range(static_cast<double>(std::numeric_limits<float>::denorm_min())));
    EXPECT_TRUE(in_expansion_range(static_cast<double>(std::numeric_limits<float>::lowest())));
    EXPECT_FALSE(in_expansion_range(std::numeric_limits<double>::denorm_min()));
    EXPECT_FALSE(in_expansion_range(std::numeric_limits<double>::max()));
}

// Uses numbers at both ends of the range, with full mantissas, in determinants that nearly cancel.
TEST(Predicates, expansions_are_exact_at_the_edges_of_their_range) {
    std::mt19937_64 engine(5);
    const std::array ends{0x1p-300, 0x1p-299, 0x1p299};
    const auto number = [&](double end) {
        const double mantissa = 1 + static_cast<double>(engine() >> 12) * 0x1p-52;
        return (engine() & 1 ? 1 : -1) * end * mantissa;
    };
    for (int i = 0; i < 3'000; ++i) {
        const auto point = [&] {
            const auto pick = [&] { return number(ends[i % 4 == 3 ? engine() % 3 : static_cast<std::size_t>(i % 4)]); };
            return Vec3d{pick(), pick(), pick()};
        };
        const Vec3d a = point(), b = point(), c = point();
        // Halfway between b and c up to rounding, or anywhere.
        const Vec3d d = i % 2 ? b + 0.5 * (c - b) : point();
        if (!in_expansion_range(d)) continue;
        ASSERT_EQ(orient3d_exact(a, b, c, d), rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
        ASSERT_EQ(orient2d_exact(b, c, d, 2), rational_orient2d(b, c, d, 2)) << describe(a, b, c, d);
        const int sign = orient3d_filtered(a, b, c, d);
        if (sign != undecided) {
            ASSERT_EQ(sign, rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
        }
    }
}

// Uses integers of up to 44 bits times a power of two, and nearly coplanar points. Turns must be decided up to 40 bits,
// sides of planes below 40 bits.
TEST(Predicates, scaled_integers_below_40_bits_are_decided_in_integers) {
    std::mt19937_64 engine(6);
    for (const int bits : {3, 20, 39, 40, 42, 44})
        for (const int exponent : {-290, -20, 0, 250})
            for (int i = 0; i < 500; ++i) {
                const auto number = [&] {
                    const auto magnitude = static_cast<double>(engine() >> (64 - bits));
                    return std::ldexp(engine() & 1 ? magnitude : -magnitude, exponent);
                };
                const Vec3d a{}, b{number(), number(), number()}, c{number(), number(), number()};
                const Vec3d step{i % 3 ? 0 : std::ldexp(1, exponent), 0, 0};
                const Vec3d d = i % 5 ? Vec3d{b.x / 2 + c.x / 2, b.y / 2 + c.y / 2, b.z / 2 + c.z / 2} + step : b;
                const int sign = detail::orient3d_whole(a, b, c, d), turn = detail::orient2d_whole(a, b, c, 0, 1);
                if (bits < 40) {
                    ASSERT_NE(sign, undecided);
                }
                if (bits <= 40) {
                    ASSERT_NE(turn, undecided);
                }
                if (sign != undecided) {
                    ASSERT_EQ(sign, rational_orient3d(a, b, c, d)) << describe(a, b, c, d);
                }
                if (turn != undecided) {
                    ASSERT_EQ(turn, rational_orient2d(a, b, c, 2)) << describe(a, b, c, d);
                }
            }
    const Vec3d o{}, third{1.0 / 3, 0, 0}, one{1, 1e-9, 1};
    EXPECT_EQ(detail::orient3d_whole(o, third, one, {0, 0, 1}), undecided) << "it is not whole";
    EXPECT_EQ(detail::orient3d_whole({1e-30, 0, 0}, {1, 0, 0}, one, {0, 0, 1}), undecided) << "differences are rounded";
    EXPECT_EQ(detail::orient3d_whole(o, o, o, o), 0);
}

TEST(Predicates, filters_decide_nearly_all_random_points) {
    RandomPairs random(Kind::random_float, 13);
    int sides = 0, turns = 0;
    for (int i = 0; i < 10'000; ++i) {
        const Vec3d a = random.point(), b = random.point(), c = random.point(), d = random.point();
        sides += orient3d_filtered(a, b, c, d) != undecided;
        turns += orient2d_filtered(a, b, c, i % 3) != undecided;
    }
    EXPECT_GT(sides, 9'990);
    EXPECT_GT(turns, 9'990);
}

}  // namespace
}  // namespace crumple
