#include "geometry/expansion.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/exact.h"
#include "rounds.h"

namespace crumple {
namespace {

class Numbers {
   public:
    double operator()() {
        const double magnitude = std::ldexp(mantissa_(engine_), exponent_(engine_));
        return engine_() & 1 ? magnitude : -magnitude;
    }
    /// Returns a number of few bits, as left by cancellation.
    double rounded() { return static_cast<float>((*this)()); }

   private:
    std::mt19937_64 engine_{1};
    std::uniform_real_distribution<double> mantissa_{0.5, 1};
    std::uniform_int_distribution<int> exponent_{-60, 60};
};

template <int N>
void expect_proper(const Expansion<N>& e) {
    for (int i = 0; i < e.size; ++i) ASSERT_NE(e.term[i], 0);
    // Terms that do not overlap: each is a multiple of a power of two above all smaller terms.
    for (int i = 1; i < e.size; ++i) {
        int last_place = 0;
        double mantissa = std::frexp(e.term[i], &last_place);
        while (mantissa != std::trunc(mantissa)) mantissa *= 2, --last_place;
        ASSERT_LT(std::abs(e.term[i - 1]), std::ldexp(1, last_place));
    }
}

TEST(Expansion, sums_and_products_of_two_numbers_are_exact) {
    Numbers number;
    for (int i = 0; i < scaled_rounds(20'000); ++i) {
        const double a = number(), b = i % 2 ? number() : number.rounded();
        ASSERT_EQ(value(two_sum(a, b)), Rational(a) + Rational(b)) << a << " + " << b;
        ASSERT_EQ(value(two_product(a, b)), Rational(a) * Rational(b)) << a << " * " << b;
        if (std::abs(a) >= std::abs(b)) {
            ASSERT_EQ(value(fast_two_sum(a, b)), Rational(a) + Rational(b)) << a << " + " << b;
        }
    }
}

TEST(Expansion, holds_sums_differences_and_products_exactly) {
    Numbers number;
    for (int i = 0; i < scaled_rounds(5'000); ++i) {
        const auto next = [&] { return i % 2 ? number() : number.rounded(); };
        const Expansion<2> a = exact_difference(next(), next()), b = exact_difference(next(), next());
        const auto sum = a + b, difference = a - b;
        const auto product = a * b;
        const auto square = product * product;
        const auto all = square - product * a;
        ASSERT_EQ(value(sum), value(a) + value(b));
        ASSERT_EQ(value(difference), value(a) - value(b));
        ASSERT_EQ(value(product), value(a) * value(b));
        ASSERT_EQ(value(square), value(product) * value(product));
        ASSERT_EQ(value(all), value(square) - value(product) * value(a));
        ASSERT_EQ(all.sign(), value(all).sign());
        expect_proper(sum);
        expect_proper(product);
        expect_proper(square);
        expect_proper(all);
    }
}

TEST(Expansion, equal_expansions_cancel_to_zero) {
    const Expansion<2> a = exact_difference(1, 0x1p-60), b = exact_difference(3, 0x1p-70);
    EXPECT_EQ((a * b - b * a).sign(), 0);
    EXPECT_EQ((a - a).size, 0);
    EXPECT_EQ(((a - a) * b).size, 0);
    EXPECT_EQ((a * (b - b)).size, 0);
}

TEST(Expansion, sign_of_a_tiny_difference_is_exact) {
    const auto a = exact_difference(1, 0x1p-300), b = exact_difference(1, 0);
    EXPECT_EQ((a - b).sign(), -1);
    EXPECT_EQ((b - a).sign(), 1);
}

}  // namespace
}  // namespace crumple
