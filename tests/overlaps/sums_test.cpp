// Tests of exact sums, and of their rounding.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/rational_sum.h"

namespace crumple {
namespace {

double random_double(std::mt19937_64& random, int least, int most) {
    const double mantissa = std::uniform_real_distribution<double>(0.5, 1)(random) * (random() % 2 ? 1 : -1);
    return std::ldexp(mantissa, std::uniform_int_distribution<int>(least, most)(random));
}

double rounded(const Rational& x) {
    Cancellation none;
    RationalSum sum;
    sum.add(x);
    return sum.rounded_quotient(1, none).value;
}

TEST(FixedSum, quotients_of_sums_are_rounded_once_at_extreme_magnitudes) {
    std::mt19937_64 random(7);
    for (int round = 0; round < 300; ++round) {
        FixedSum sum;
        Rational exact = 0;
        const int terms = 1 + static_cast<int>(random() % 40);
        for (int i = 0; i < terms; ++i) {
            const double x = round % 2 ? random_double(random, -1073, 1000) : random_double(random, -60, 60);
            sum.add(x);
            exact += Rational(x);
            if (random() % 4 == 0) sum.add(-x), exact -= Rational(x);
        }
        for (const int divisor : {1, 3, 6, 18, 72}) {
            const Rational quotient = exact / divisor;
            const auto rounded_sum = sum.rounded_quotient(divisor);
            ASSERT_TRUE(rounded_sum);
            EXPECT_EQ(rounded_sum->value, rounded(quotient)) << divisor;
        }
    }
}

TEST(FixedSum, parts_add_up_to_the_whole) {
    std::mt19937_64 random(8);
    FixedSum whole, first, second;
    for (int i = 0; i < 100; ++i) {
        const double x = random_double(random, -300, 300);
        whole.add(x);
        (i % 3 ? first : second).add(x);
    }
    first.add(second);
    EXPECT_EQ(first.rounded_quotient(7)->value, whole.rounded_quotient(7)->value);
}

TEST(FixedSum, products_of_sums_and_factors_are_rounded_once) {
    std::mt19937_64 random(9);
    for (int round = 0; round < 200; ++round) {
        FixedSum sum, product;
        Rational exact = 0;
        for (int i = 0; i < 5; ++i) {
            const double x = random_double(random, -200, 200);
            sum.add(x);
            exact += Rational(x);
        }
        const double factor = random_double(random, -100, 100);
        product.add_product(sum, factor);
        EXPECT_EQ(product.rounded_quotient(1)->value, rounded(exact * Rational(factor)));
        product.add_product(sum, factor, 3);
        EXPECT_EQ(product.rounded_quotient(1)->value, rounded(4 * exact * Rational(factor)));
    }
}

TEST(FixedSum, sums_that_the_bound_cannot_decide_are_not_rounded) {
    FixedSum sum;
    sum.add(Enclosed({1, 0}, 0x1p-60));
    ASSERT_TRUE(sum.rounded_quotient(1));
    EXPECT_EQ(sum.rounded_quotient(1)->value, 1);
    sum.add(Enclosed({0x1p-53, 0}, 0));  // half a unit in the last place
    EXPECT_FALSE(sum.rounded_quotient(1));
    FixedSum nothing;
    nothing.add(Enclosed({0, 0}, 0x1p-200));
    EXPECT_FALSE(nothing.rounded_quotient(1));
}

TEST(RationalSum, ties_and_zero_are_decided_exactly) {
    Cancellation none;
    RationalSum zero;
    for (int i = 2; i < 40; ++i) zero.add(Rational(1, i)), zero.add(Rational(-1, i + 40));
    Rational total = 0;
    for (int i = 2; i < 40; ++i) total += Rational(1, i) - Rational(1, i + 40);
    zero.add(-total);
    EXPECT_EQ(zero.rounded_quotient(5, none).value, 0);
    RationalSum tie;
    tie.add(Rational(1, 3));
    tie.add(Rational(2, 3));
    tie.add(Rational(1, mp::cpp_int(1) << 53));
    EXPECT_EQ(tie.rounded_quotient(1, none).value, 1);  // to even
    tie.add(Rational(1, mp::cpp_int(1) << 900));
    EXPECT_EQ(tie.rounded_quotient(1, none).value, 1 + 0x1p-52);
}

TEST(RootSum, roots_are_rounded_once_and_rational_roots_are_exact) {
    Cancellation none;
    RootSum sum;
    EXPECT_EQ(sum.rounded_quotient(1, none).value, 0);
    sum.times_root_of(Rational(9, 4)).add(Rational(1, 3));
    EXPECT_EQ(sum.rounded_quotient(1, none).value, 0.5);
    sum.times_root_of(Rational(1)).add(Rational(1, mp::cpp_int(1) << 54));  // a tie, to even
    EXPECT_EQ(sum.rounded_quotient(1, none).value, 0.5);
    // A root far below the last place decides the tie.
    sum.times_root_of(Rational(2)).add(Rational(1, mp::cpp_int(1) << 900));
    EXPECT_EQ(sum.rounded_quotient(1, none).value, 0.5 + 0x1p-53);
    RootSum two;
    two.times_root_of(Rational(2)).add(Rational(1));
    two.add(two);
    EXPECT_EQ(two.rounded_quotient(2, none).value, std::sqrt(2.0));
    EXPECT_EQ(two.rounded_quotient(1, none).value, 2 * std::sqrt(2.0));
}

TEST(RationalSum, numbers_beyond_float64_have_a_separate_exponent) {
    Cancellation none;
    RationalSum small, large;
    small.add(Rational(3, mp::cpp_int(1) << 2000));
    large.add(Rational(mp::cpp_int(3) << 2000));
    const RoundedSum below = small.rounded_quotient(1, none), above = large.rounded_quotient(1, none);
    EXPECT_EQ(below.value, 0);
    EXPECT_EQ(above.value, std::numeric_limits<double>::infinity());
    EXPECT_EQ((below.scaled * above.scaled).value(), 9);
    EXPECT_EQ((above.scaled / above.scaled).value(), 1);
    small.add(Rational(1, mp::cpp_int(1) << 1074));
    EXPECT_EQ(small.rounded_quotient(1, none).value, 0x1p-1074);
}

}  // namespace
}  // namespace crumple
