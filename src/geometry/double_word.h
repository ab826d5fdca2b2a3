#pragma once

// Arithmetic with about 106 bits: numbers are unevaluated sums of two float64 numbers. Algorithms and relative error
// bounds from M. Joldes, J.-M. Muller, V. Popescu, "Tight and Rigorous Error Bounds for Basic Building Blocks of
// Double-Word Arithmetic" (2017), with u = 2^-53. The bounds hold for operands of any signs, if nothing over- or
// underflows.

#include "geometry/expansion.h"

namespace crumple {

using DoubleWord = TwoTerms;

/// Algorithm 6, error below 3.01 u² < 2^-103.
CRUMPLE_HD inline DoubleWord operator+(DoubleWord x, DoubleWord y) {
    const TwoTerms high = two_sum(x.high, y.high), low = two_sum(x.low, y.low);
    const TwoTerms middle = fast_two_sum(high.high, high.low + low.high);
    return fast_two_sum(middle.high, low.low + middle.low);
}
CRUMPLE_HD inline DoubleWord operator-(DoubleWord x) { return {-x.high, -x.low}; }
CRUMPLE_HD inline DoubleWord operator-(DoubleWord x, DoubleWord y) { return x + -y; }

/// Algorithm 10, error at most 7 u² < 2^-103.
CRUMPLE_HD inline DoubleWord operator*(DoubleWord x, DoubleWord y) {
    const TwoTerms high = two_product(x.high, y.high);
    return fast_two_sum(high.high, high.low + (x.high * y.low + x.low * y.high));
}

/// Algorithm 17, error below 15.01 u² < 2^-102.
CRUMPLE_HD inline DoubleWord operator/(DoubleWord x, DoubleWord y) {
    const double quotient = x.high / y.high;
    const TwoTerms first = two_product(y.high, quotient);
    const TwoTerms product = fast_two_sum(first.high, y.low * quotient + first.low);
    const double remainder = (x.high - product.high) + (x.low - product.low);
    return fast_two_sum(quotient, remainder / y.high);
}

}  // namespace crumple
