#pragma once

// Double words (unevaluated sums of two float64 numbers, geometry/double_word.h) with an error bound that all
// operations propagate. Compiled for host and device.
//
// The bounds are those of double_word.h, with u = 2^-53: the relative error is at most 3.01 u² for a sum, 7 u² for a
// product, and 15.01 u² for a quotient. The constants below are at least 6 % larger, and the factor `above` covers all
// roundings in the computation of a bound. Nothing may overflow, and no product of two parts may underflow.
//
// Sums and products of two numbers that are single float64 numbers are exact, and so are their quotients if there is no
// remainder. So coordinates that are small integers, as in many scenes made by hand, give results with an error bound
// of 0.

#include <cmath>
#include <limits>
#include <optional>

#include "geometry/double_word.h"

namespace crumple {

struct Enclosed {
    DoubleWord value{0, 0};
    double error = 0;  ///< bound on the distance of the true number from `value`

    Enclosed() = default;
    CRUMPLE_HD Enclosed(DoubleWord v, double e) : value(v), error(e) {}
    CRUMPLE_HD explicit Enclosed(double x) : value{x, 0} {}
    /// Returns x − y, exactly.
    CRUMPLE_HD static Enclosed difference(double x, double y) { return {two_sum(x, -y), 0}; }

    CRUMPLE_HD double magnitude() const { return std::abs(value.high); }
};

namespace detail {
inline constexpr double above = 1 + 0x1p-40;  ///< factor that rounds an error bound up
}

CRUMPLE_HD inline Enclosed operator+(const Enclosed& x, const Enclosed& y) {
    const DoubleWord sum = x.value + y.value;
    const double rounding = x.value.low == 0 && y.value.low == 0 ? 0 : 0x1p-104 * std::abs(sum.high);
    return {sum, detail::above * (x.error + y.error + rounding)};
}
CRUMPLE_HD inline Enclosed operator-(const Enclosed& x) { return {-x.value, x.error}; }
CRUMPLE_HD inline Enclosed operator-(const Enclosed& x, const Enclosed& y) { return x + -y; }
CRUMPLE_HD inline Enclosed operator*(const Enclosed& x, const Enclosed& y) {
    const DoubleWord product = x.value * y.value;
    const double error = x.magnitude() * y.error + (y.magnitude() + y.error) * x.error;
    const double rounding = x.value.low == 0 && y.value.low == 0 ? 0 : 0x1p-103 * std::abs(product.high);
    return {product, detail::above * (error + rounding)};
}
/// The error bound is infinite if the divisor may be 0.
CRUMPLE_HD inline Enclosed operator/(const Enclosed& x, const Enclosed& y) {
    const double least = (1 - 0x1p-40) * (y.magnitude() - detail::above * y.error);
    if (!(least > 0)) return {{0, 0}, std::numeric_limits<double>::infinity()};
    const DoubleWord quotient = x.value / y.value;
    const double error = (x.error + std::abs(quotient.high) * y.error) / least;
    const TwoTerms back = two_product(quotient.high, y.value.high);
    const bool exact =
        quotient.low == 0 && x.value.low == 0 && y.value.low == 0 && back.low == 0 && back.high == x.value.high;
    return {quotient, detail::above * (error + (exact ? 0 : 0x1p-102 * std::abs(quotient.high)))};
}

/// Returns the square root of a positive x. The error bound is infinite unless x exceeds twice its own error bound.
inline Enclosed sqrt(const Enclosed& x) {
    const double root = std::sqrt(x.value.high);
    if (!(x.magnitude() > 2 * x.error)) return {{root, 0}, std::numeric_limits<double>::infinity()};
    // One step of Newton's method: `root` has a relative error of 2^-52, which the step reduces to 2^-105.
    const DoubleWord rest = x.value - two_product(root, root);
    const DoubleWord value = fast_two_sum(root, rest.high / (2 * root));
    const double rounding = rest.high == 0 ? 0 : 0x1p-102 * root;
    return {value, detail::above * (x.error / root + rounding)};
}

/// Returns the float64 nearest to x / divisor, ties to even, or nothing if that is not certain.
inline std::optional<double> nearest_quotient(const Enclosed& x, double divisor) {
    const Enclosed quotient = x / Enclosed(divisor);
    const auto [high, low] = quotient.value;
    if (quotient.error == 0) return high + 0.0;  // never -0
    const double error = detail::above * quotient.error + 0x1p-52 * std::abs(low);
    const double least = high + (low - error), most = high + (low + error);
    return least == most ? std::optional(least + 0.0) : std::nullopt;
}

/// Returns p − q, exactly.
CRUMPLE_HD inline Vec3<Enclosed> enclosed_difference(const Vec3d& p, const Vec3d& q) {
    return {Enclosed::difference(p.x, q.x), Enclosed::difference(p.y, q.y), Enclosed::difference(p.z, q.z)};
}

}  // namespace crumple
