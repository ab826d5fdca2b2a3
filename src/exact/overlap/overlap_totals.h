#pragma once

// From the sums over an overlap to the numbers that a result has, for any type of sum that knows when it rounds for
// certain (docs/overlap.md).

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "exact/overlap/scaled.h"
#include "geometry/double_word.h"
#include "geometry/vec.h"

namespace crumple {

/// Sums of terms about the origin O. Curves are summed for both shifts.
template <class Sum>
struct OverlapTotals {
    Sum volume;                 ///< 18 V
    std::array<Sum, 3> moment;  ///< 24 (∫ x − V O)
    std::array<Sum, 3> area;    ///< 4 S
    std::array<Sum, 3> torque;  ///< −12 T about O
};

struct OverlapNumbers {
    RoundedSum volume;
    Vec3d centroid;     ///< NaN where the volume is 0
    Vec3d area_vector;  ///< correctly rounded
    Vec3d point;        ///< the centroid, or O
    Vec3d torque;       ///< about that point exactly, correctly rounded
    Vec3d normal;       ///< NaN where the area vector is 0
    double mean_depth = std::numeric_limits<double>::quiet_NaN();
};

namespace detail {

/// The length of a vector of three scaled numbers, not all 0, and the vector divided by it, each within 2 units in the
/// last place.
struct ScaledDirection {
    Scaled length;
    Vec3d direction;

    explicit ScaledDirection(const std::array<RoundedSum, 3>& v) {
        int exponent = std::numeric_limits<int>::min();
        for (const RoundedSum& x : v)
            if (x.scaled.mantissa != 0) exponent = std::max(exponent, x.scaled.exponent);
        std::array<double, 3> part{};
        DoubleWord square{0, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            part[k] = std::ldexp(v[k].scaled.mantissa, std::max(v[k].scaled.exponent - exponent, -1000));
            square = square + two_product(part[k], part[k]);
        }
        const double root = std::sqrt(square.high);
        const DoubleWord rest = square - two_product(root, root);
        const DoubleWord exact = fast_two_sum(root, rest.high / (2 * root));
        length = Scaled(exact.high, exponent);
        for (int axis = 0; axis < 3; ++axis)
            direction[axis] = (DoubleWord{part[static_cast<std::size_t>(axis)], 0} / exact).high;
    }
};

}  // namespace detail

/// Fills in the numbers. `round(sum, divisor)` is a RoundedSum, or nothing where the sum does not tell: then false is
/// returned. `self`: the sums are twice those of a body's overlap with itself.
template <class Sum, class Round>
bool finish(const OverlapTotals<Sum>& totals, const Vec3d& origin, bool self, Round round, OverlapNumbers& numbers) {
    const auto next = [](std::size_t k) { return k == 2 ? std::size_t{0} : k + 1; };
    const auto all = [&](const std::array<Sum, 3>& sums, int divisor, std::array<RoundedSum, 3>& rounded) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto known = round(sums[k], divisor);
            if (!known) return false;
            rounded[k] = *known;
        }
        return true;
    };
    const auto values = [](const std::array<RoundedSum, 3>& v) { return Vec3d{v[0].value, v[1].value, v[2].value}; };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    const auto volume = round(totals.volume, 18);
    const auto own_volume = self ? round(totals.volume, 36) : volume;
    if (!volume || !own_volume) return false;
    numbers.volume = *own_volume;
    numbers.centroid = {nan, nan, nan};
    numbers.point = origin;
    if (volume->scaled.mantissa != 0) {
        std::array<Sum, 3> sums;
        std::array<RoundedSum, 3> moment;
        for (std::size_t k = 0; k < 3; ++k) {
            sums[k].add_product(totals.moment[k], 3);
            sums[k].add_product(totals.volume, 4 * origin[static_cast<int>(k)]);
        }
        if (!all(sums, 72, moment)) return false;
        for (int axis = 0; axis < 3; ++axis)
            numbers.centroid[axis] = (moment[static_cast<std::size_t>(axis)].scaled / volume->scaled).value();
        numbers.point = numbers.centroid;
    }

    std::array<RoundedSum, 3> area, torque;
    if (!all(totals.area, 4, area)) return false;
    numbers.area_vector = values(area);
    std::array<Sum, 3> sums;
    for (std::size_t k = 0; k < 3; ++k) {
        sums[k].add_product(totals.torque[k], -1);
        // 3 (O − c) × (4 S), the difference in two parts
        const auto add = [&](std::size_t axis, std::size_t of_area, double sign) {
            const int i = static_cast<int>(axis);
            const TwoTerms away = two_sum(origin[i], -numbers.point[i]);
            for (const double part : {away.high, away.low})
                for (int times = 0; times < 3; ++times) sums[k].add_product(totals.area[of_area], sign * part);
        };
        add(next(k), next(next(k)), 1);
        add(next(next(k)), next(k), -1);
    }
    if (!all(sums, 12, torque)) return false;
    numbers.torque = values(torque);

    numbers.normal = {nan, nan, nan};
    numbers.mean_depth = nan;
    if (area[0].scaled.mantissa != 0 || area[1].scaled.mantissa != 0 || area[2].scaled.mantissa != 0) {
        const detail::ScaledDirection along(area);
        numbers.normal = along.direction;
        numbers.mean_depth = (volume->scaled / along.length).value();
    }
    return true;
}

}  // namespace crumple
