#pragma once

// Double words with a bound on their error, which the operations keep. Compiled for host and device.
//
// The bounds are those of double_word.h, u = 2^-53: a sum is off by at most 3.01 u² of itself, a product by 7 u², a
// quotient by 15.01 u². The constants below are larger by a tenth at least, and `above` by more than all roundings of a
// bound itself. Nothing may overflow, and no product of two parts may underflow.
//
// Sums and products of two numbers that are float64 numbers exactly are exact, and so are quotients without remainder.
// So small whole numbers, as in many scenes made by hand, have a bound of 0.

#include <cmath>
#include <limits>
#include <optional>

#include "geometry/double_word.h"

namespace crumple {

struct Enclosed {
    DoubleWord value{0, 0};
    double error = 0;  ///< the number is at most so far from `value`

    Enclosed() = default;
    CRUMPLE_HD Enclosed(DoubleWord v, double e) : value(v), error(e) {}
    CRUMPLE_HD explicit Enclosed(double x) : value{x, 0} {}
    /// x − y, exactly.
    CRUMPLE_HD static Enclosed difference(double x, double y) { return {two_sum(x, -y), 0}; }

    CRUMPLE_HD double magnitude() const { return std::abs(value.high); }
};

namespace detail {
inline constexpr double above = 1 + 0x1p-40;
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
/// The bound is infinite where the divisor may be 0.
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

/// x is positive; the bound is infinite where it may not be.
inline Enclosed sqrt(const Enclosed& x) {
    const double root = std::sqrt(x.value.high);
    if (!(x.magnitude() > 2 * x.error)) return {{root, 0}, std::numeric_limits<double>::infinity()};
    // A step of Newton's method: root is off by 2^-52 of itself, so that the step leaves 2^-105 of it.
    const DoubleWord rest = x.value - two_product(root, root);
    const DoubleWord value = fast_two_sum(root, rest.high / (2 * root));
    const double rounding = rest.high == 0 ? 0 : 0x1p-102 * root;
    return {value, detail::above * (x.error / root + rounding)};
}

/// The float64 number nearest to x / divisor, ties to even, if that is certain.
inline std::optional<double> nearest_quotient(const Enclosed& x, double divisor) {
    const Enclosed quotient = x / Enclosed(divisor);
    const auto [high, low] = quotient.value;
    if (quotient.error == 0) return high + 0.0;  // never -0
    const double error = detail::above * quotient.error + 0x1p-52 * std::abs(low);
    const double least = high + (low - error), most = high + (low + error);
    return least == most ? std::optional(least + 0.0) : std::nullopt;
}

/// p − q, exactly.
CRUMPLE_HD inline Vec3<Enclosed> enclosed_difference(const Vec3d& p, const Vec3d& q) {
    return {Enclosed::difference(p.x, q.x), Enclosed::difference(p.y, q.y), Enclosed::difference(p.z, q.z)};
}

}  // namespace crumple
