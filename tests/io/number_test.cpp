// Numbers of text files that are out of the range of float64.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/bytes/text.h"

namespace crumple::io {
namespace {

TEST(Number, number_keeps_its_sign_when_it_overflows_or_underflows) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(number_of("1e400"), infinity);
    EXPECT_EQ(number_of("-1e400"), -infinity);
    EXPECT_EQ(number_of("+1e400"), infinity);
    EXPECT_EQ(number_of("1e-400"), 0);
    EXPECT_TRUE(std::signbit(*number_of("-1e-400")));
    EXPECT_FALSE(std::signbit(*number_of("1e-400")));
}

}  // namespace
}  // namespace crumple::io
