#pragma once

// Computes the numbers of an overlap's result from its sums, for any type of sum that can be rounded correctly
// (docs/overlap.md). Notation: V is the volume of the overlap, S its area vector, T its torque, and O the origin that
// the terms of the sums are relative to.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "exact/overlap/scaled.h"
#include "geometry/double_word.h"
#include "geometry/vec.h"

namespace crumple {

// Sums of the terms of pair_terms.h. For the overlap of a body with itself they are twice as large as the comments say.

template <class Sum>
struct VolumeTotals {
    Sum volume;                 ///< 6 V
    std::array<Sum, 3> moment;  ///< 24 (∫ x − V O)

    void add(const VolumeTotals& other) {
        volume.add(other.volume);
        for (std::size_t k = 0; k < 3; ++k) moment[k].add(other.moment[k]);
    }
};
/// Sums over the segments of both shifts (face_crossing.h): twice those of the mean of both.
template <class Sum>
struct CurveTotals {
    std::array<Sum, 3> area;    ///< 4 S
    std::array<Sum, 3> torque;  ///< −12 T about O

    void add(const CurveTotals& other) {
        for (std::size_t k = 0; k < 3; ++k) area[k].add(other.area[k]), torque[k].add(other.torque[k]);
    }
};

struct OverlapNumbers {
    RoundedSum volume;
    Vec3d centroid;     ///< NaN where the volume is 0
    Vec3d area_vector;  ///< correctly rounded
    Vec3d point;        ///< the centroid, or O
    Vec3d torque;       ///< about `point` as rounded; correctly rounded itself
    Vec3d normal;       ///< NaN where the area vector is 0
    double mean_depth = std::numeric_limits<double>::quiet_NaN();
    double contact_area = 0;  ///< correctly rounded; not computed from these sums
};

namespace detail {

/// Length and direction of a nonzero vector of three scaled numbers. The length and each component of the direction are
/// within 2 units in the last place.
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

/// Area vector, and torque about a point, computed from sums over segments.
struct CurveNumbers {
    std::array<RoundedSum, 3> area, torque;

    static Vec3d values(const std::array<RoundedSum, 3>& v) { return {v[0].value, v[1].value, v[2].value}; }
};

/// Computes the area vector and the torque about `point`. `sums` provides curves(combine, divisor), as for finish();
/// `origin` is O.
template <class Sums>
CurveNumbers finish_curves(Sums& sums, const Vec3d& origin, const Vec3d& point) {
    const auto next = [](std::size_t k) { return k == 2 ? std::size_t{0} : k + 1; };
    CurveNumbers numbers;
    for (std::size_t k = 0; k < 3; ++k) {
        numbers.area[k] = sums.curves([&](const auto& totals) { return totals.area[k]; }, 4);
        const auto about_point = [&](const auto& totals) {
            std::remove_cvref_t<decltype(totals.torque[k])> sum;
            sum.add_product(totals.torque[k], -1);
            // 3 (O − c) × (4 S), where c is `point`, with O − c as a sum of two float64
            const auto add = [&](std::size_t axis, std::size_t of_area, double sign) {
                const int i = static_cast<int>(axis);
                TwoTerms away = two_sum(origin[i], -point[i]);
                if (!std::isfinite(away.high)) away = {origin[i], -point[i]};
                for (const double part : {away.high, away.low}) sum.add_product(totals.area[of_area], sign * part, 3);
            };
            add(next(k), next(next(k)), 1);
            add(next(next(k)), next(k), -1);
            return sum;
        };
        numbers.torque[k] = sums.curves(about_point, 12);
    }
    return numbers;
}

/// Computes all numbers but contact_area. `sums` provides volume(combine, divisor) and curves(combine, divisor), which
/// return what `combine` computes from the totals, divided by `divisor`, as a RoundedSum. `self`: true if the sums are
/// of a body with itself.
template <class Sums>
OverlapNumbers finish(Sums& sums, const Vec3d& origin, bool self) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    OverlapNumbers numbers;
    const auto six_volumes = [](const auto& totals) { return totals.volume; };
    numbers.volume = sums.volume(six_volumes, self ? 12 : 6);
    numbers.centroid = numbers.normal = {nan, nan, nan};
    numbers.point = origin;
    if (numbers.volume.scaled.mantissa != 0) {
        const RoundedSum volume = self ? sums.volume(six_volumes, 6) : numbers.volume;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto moment = [&](const auto& totals) {
                auto sum = totals.moment[k];
                sum.add_product(totals.volume, origin[static_cast<int>(k)], 4);
                return sum;
            };
            numbers.centroid[static_cast<int>(k)] = (sums.volume(moment, 24).scaled / volume.scaled).value();
        }
        if (all_finite(numbers.centroid)) numbers.point = numbers.centroid;
    }

    const auto [area, torque] = finish_curves(sums, origin, numbers.point);
    numbers.area_vector = CurveNumbers::values(area);
    numbers.torque = CurveNumbers::values(torque);
    if (area[0].scaled.mantissa != 0 || area[1].scaled.mantissa != 0 || area[2].scaled.mantissa != 0) {
        const detail::ScaledDirection along(area);
        numbers.normal = along.direction;
        numbers.mean_depth = (numbers.volume.scaled / along.length).value();
    }
    return numbers;
}

}  // namespace crumple
