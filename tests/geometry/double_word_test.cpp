#include "geometry/double_word.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/exact.h"
#include "rounds.h"

namespace crumple {
namespace {

void expect_near(DoubleWord computed, const Rational& exact, double relative, const char* operation) {
    ASSERT_LE(abs(value(computed) - exact), abs(exact) * Rational(relative)) << operation;
    ASSERT_EQ(computed.high, computed.high + computed.low) << operation << " leaves overlapping words";
}

TEST(DoubleWord, operations_stay_within_their_error_bounds) {
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int i = 0; i < scaled_rounds(20'000); ++i) {
        DoubleWord x = two_sum(number(engine), number(engine) * 0x1p-53);
        DoubleWord y = two_sum(number(engine), number(engine) * 0x1p-53);
        if (i % 4 == 0) y = two_sum(-x.high, number(engine) * 0x1p-54);  // their sum nearly cancels
        expect_near(x + y, value(x) + value(y), 0x1p-103, "sum");
        expect_near(x - y, value(x) - value(y), 0x1p-103, "difference");
        expect_near(x * y, value(x) * value(y), 0x1p-103, "product");
        expect_near(x / y, value(x) / value(y), 0x1p-102, "quotient");
    }
}

}  // namespace
}  // namespace crumple
