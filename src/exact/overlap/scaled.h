#pragma once

// Float64 numbers whose exponent is kept apart, so that products and quotients of results that float64 could not hold
// neither overflow nor vanish.

#include <cmath>

#include "geometry/vec.h"

namespace crumple {

/// mantissa · 2^exponent; the mantissa is 0 or from 1/2 to below 1 in magnitude.
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
    /// y is not 0.
    friend Scaled operator/(const Scaled& x, const Scaled& y) {
        return Scaled(x.mantissa / y.mantissa, x.exponent - y.exponent);
    }
};

/// A number rounded to nearest, ties to even, in float64 and where float64 has no such exponent.
struct RoundedSum {
    double value = 0;
    Scaled scaled;
};

}  // namespace crumple
