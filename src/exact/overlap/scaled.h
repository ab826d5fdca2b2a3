#pragma once

// Float64 numbers with a separate exponent, so that products and quotients of results neither overflow nor underflow.

#include <cmath>

#include "geometry/vec.h"

namespace crumple {

/// Number mantissa · 2^exponent. The magnitude of the mantissa is 0 or in [1/2, 1).
struct Scaled {
    double mantissa = 0;
    int exponent = 0;

    Scaled() = default;
    explicit Scaled(double x, int power = 0) {
        mantissa = std::frexp(x, &exponent);
        if (x != 0) exponent += power;
    }
    double value() const { return std::ldexp(mantissa, exponent); }

    friend Scaled operator*(const Scaled& x, const Scaled& y) {
        return Scaled(x.mantissa * y.mantissa, x.exponent + y.exponent);
    }
    /// Precondition: y is not 0.
    friend Scaled operator/(const Scaled& x, const Scaled& y) {
        return Scaled(x.mantissa / y.mantissa, x.exponent - y.exponent);
    }
};

/// Number rounded to nearest, ties to even: as a float64, and to 53 bits with an unlimited exponent.
struct RoundedSum {
    double value = 0;
    Scaled scaled;
};

}  // namespace crumple
