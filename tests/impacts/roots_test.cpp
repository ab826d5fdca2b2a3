#include "exact/impact/roots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>

namespace crumple {
namespace {

/// Returns the polynomial with these coefficients, constant term first.
Polynomial polynomial(std::initializer_list<Integer> coefficients) { return Polynomial(coefficients); }

/// Returns q t − k, which is zero at k / q.
Polynomial zero_at(const Integer& k, const Integer& q) { return polynomial({-k, q}); }

std::vector<double> rounded_roots(const Polynomial& p) {
    std::vector<double> result;
    for (Root& root : roots_in_unit_interval(p)) result.push_back(root.rounded_down());
    return result;
}

Integer power(unsigned exponent) { return Integer(1) << exponent; }

TEST(Polynomial, drops_leading_zeros) {
    EXPECT_EQ(polynomial({1, 2, 0, 0}).degree(), 1);
    EXPECT_TRUE(polynomial({0, 0}).zero());
    EXPECT_TRUE((polynomial({1, 2}) - polynomial({1, 2})).zero());
    EXPECT_EQ((polynomial({1, 2, 3}) + polynomial({1, 2, -3})).coefficients(), (std::vector<Integer>{2, 4}));
}

TEST(Polynomial, operations_give_exact_coefficients) {
    const Polynomial p = zero_at(1, 3) * zero_at(2, 5) * polynomial({-7});
    EXPECT_EQ(p.coefficients(), (std::vector<Integer>{-14, 77, -105}));
    EXPECT_EQ(p.derivative().coefficients(), (std::vector<Integer>{77, -210}));
    EXPECT_EQ(p.primitive().coefficients(), (std::vector<Integer>{-2, 11, -15}));
    EXPECT_EQ(p.sign_at({1, 0}), -1);
    EXPECT_EQ(p.sign_at({3, 3}), 1);
    // zoomed({3, 3}) is 64 p((3 + u) / 8), a polynomial in u from 0 to 1: p over the interval from 3/8 to 4/8.
    EXPECT_EQ(p.zoomed({3, 3}).coefficients(), (std::vector<Integer>{7, -14, -105}));
}

TEST(GreatestCommonDivisor, contains_the_common_factors) {
    const Polynomial a = zero_at(1, 3), b = zero_at(2, 5), c = zero_at(-4, 7), d = polynomial({-2, 0, 1});
    const auto equal_up_to_sign = [](const Polynomial& p, const Polynomial& q) {
        return (p - q).zero() || (p + q).zero();
    };
    EXPECT_TRUE(equal_up_to_sign(greatest_common_divisor(std::array{a * b * d, c * d * b}), b * d));
    EXPECT_EQ(greatest_common_divisor(std::array{a * b, b * c, c * a}).degree(), 0);
    EXPECT_TRUE(equal_up_to_sign(greatest_common_divisor(std::array{Polynomial(), a * b, Polynomial(), b * c}), b));
    EXPECT_EQ(greatest_common_divisor(std::array{Polynomial(), a * polynomial({12})}).coefficients(), a.coefficients());
    EXPECT_TRUE(greatest_common_divisor(std::array{Polynomial(), Polynomial()}).zero());
    EXPECT_EQ(square_free(a * a * b * d * d * d).degree(), 4);
}

TEST(Roots, roots_are_found_once_and_in_order) {
    const Polynomial p = zero_at(1, 3) * zero_at(1, 2) * zero_at(1, 1) * zero_at(0, 1);
    EXPECT_EQ(rounded_roots(p), (std::vector<double>{0, 1.0 / 3, 0.5, 1}));
    EXPECT_EQ(rounded_roots(p * p * zero_at(1, 2)), (std::vector<double>{0, 1.0 / 3, 0.5, 1}));
    EXPECT_EQ(rounded_roots(p * zero_at(-1, 3) * zero_at(4, 3) * polynomial({1, 0, 1})), rounded_roots(p));
}

TEST(Roots, complex_roots_and_roots_outside_zero_to_one_are_left_out) {
    EXPECT_TRUE(rounded_roots(polynomial({5})).empty());
    EXPECT_TRUE(rounded_roots(zero_at(-1, power(200))).empty());
    EXPECT_TRUE(rounded_roots(zero_at(power(200) + 1, power(200))).empty());
    // Two complex roots close to 1/2 give as many sign variations (Descartes' rule of signs) as two real ones.
    EXPECT_TRUE(rounded_roots(zero_at(1, 2) * zero_at(1, 2) * polynomial({power(100)}) + polynomial({1})).empty());
    EXPECT_EQ(rounded_roots(zero_at(1, 2) * zero_at(1, 2) * polynomial({power(100)}) - polynomial({1})).size(), 2U);
}

TEST(Roots, roots_close_together_are_separated) {
    const Integer q = power(300);
    const Polynomial p = zero_at(q / 3, q) * zero_at(q / 3 + 1, q) * zero_at(q / 3 + 2, q) * zero_at(1, 3);
    std::vector<Root> roots = roots_in_unit_interval(p);
    ASSERT_EQ(roots.size(), 4U);
    // 1/3 lies between the first two roots, as 2^300 is not divisible by 3.
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(roots[i].sign(zero_at(1, 3)), i == 0 ? -1 : i == 1 ? 0 : 1) << i;
        EXPECT_EQ(roots[i].sign(zero_at(q / 3 + 1, q)), i < 2 ? -1 : i == 2 ? 0 : 1) << i;
        EXPECT_EQ(roots[i].rounded_down(), 1.0 / 3) << i;
    }
}

TEST(Roots, sign_of_another_polynomial_at_a_root_is_exact) {
    const Polynomial half = polynomial({-1, 0, 2});  // at the square root of 1/2
    Root root = roots_in_unit_interval(half).at(0);
    EXPECT_EQ(root.sign(half), 0);
    EXPECT_EQ(root.sign(half * zero_at(1, 3)), 0);
    EXPECT_EQ(root.sign(Polynomial()), 0);
    EXPECT_EQ(root.sign(polynomial({-3})), -1);
    EXPECT_EQ(root.sign(zero_at(7, 10)), 1);
    EXPECT_EQ(root.sign(zero_at(8, 10)), -1);
    // Away from zero by 2^-400 only.
    EXPECT_EQ(root.sign(half * polynomial({power(400)}) + polynomial({1})), 1);
    EXPECT_EQ(root.sign(half * polynomial({power(400)}) - polynomial({1})), -1);
    EXPECT_EQ(Root(Dyadic{1, 1}).sign(zero_at(1, 2)), 0);
}

TEST(Roots, root_is_zero_only_if_exactly_zero) {
    EXPECT_TRUE(roots_in_unit_interval(zero_at(0, 1)).at(0).is_zero());
    Root tiny = roots_in_unit_interval(zero_at(1, power(1'080))).at(0);
    EXPECT_EQ(tiny.rounded_down(), 0);
    EXPECT_FALSE(tiny.is_zero());
}

TEST(Roots, roots_are_rounded_down) {
    // Ties and what is just above or below a float64 number.
    EXPECT_EQ(rounded_roots(zero_at(power(200) - 1, power(200))), (std::vector<double>{1 - 0x1p-53}));
    EXPECT_EQ(rounded_roots(zero_at(power(199) + 1, power(200))), (std::vector<double>{0.5}));
    EXPECT_EQ(rounded_roots(zero_at(power(199) - 1, power(200))), (std::vector<double>{0.5 - 0x1p-54}));
    EXPECT_EQ(rounded_roots(zero_at(power(53) + 1, power(54))), (std::vector<double>{0.5}));
    EXPECT_EQ(rounded_roots(zero_at(power(53) + 3, power(54))), (std::vector<double>{0.5 + 0x1p-53}));
    // Subnormal ones.
    EXPECT_EQ(rounded_roots(zero_at(1, power(1'074))), (std::vector<double>{0x1p-1074}));
    EXPECT_EQ(rounded_roots(zero_at(5, 3 * power(1'074))), (std::vector<double>{0x1p-1074}));
    EXPECT_EQ(rounded_roots(zero_at(7, 3 * power(1'074))), (std::vector<double>{0x1p-1073}));
    EXPECT_EQ(rounded_roots(zero_at(1, 3 * power(1'022))), (std::vector<double>{std::ldexp(0x5555555555555, -1'074)}));
}

// Compares with k / q as the processor divides, corrected where that was rounded up.
TEST(Roots, roots_of_lines_are_quotients_rounded_down) {
    std::mt19937_64 engine(29);
    for (int i = 0; i < 2'000; ++i) {
        const auto q = static_cast<std::int64_t>(engine() >> (12 + i % 50)) + 2;
        const auto k = static_cast<std::int64_t>(engine() % static_cast<std::uint64_t>(q - 1)) + 1;
        double expected = static_cast<double>(k) / static_cast<double>(q);
        int exponent = 0;
        const Integer mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(expected, &exponent), 53));
        if ((mantissa * q) > (Integer(k) << (53 - exponent))) expected = std::nextafter(expected, 0.0);
        ASSERT_EQ(rounded_roots(zero_at(k, q)), (std::vector<double>{expected})) << k << " / " << q;
        // As a double root, with another factor.
        const Polynomial p = zero_at(k, q) * zero_at(k, q) * polynomial({1, 1, 1});
        ASSERT_EQ(rounded_roots(p), (std::vector<double>{expected})) << k << " / " << q;
    }
}

}  // namespace
}  // namespace crumple
