#pragma once

// Parameter at which an edge crosses the plane of a face, in float64 with an error bound: decides at a fraction of the
// cost of double words (enclosed_parameter.h) which points are far from each other, or far inside a box. Host only.

#include <cmath>
#include <limits>

#include "exact/overlap/face_crossing.h"
#include "geometry/predicates.h"

namespace crumple {

struct RoundedParameter {
    double value = 0;
    double error = std::numeric_limits<double>::infinity();  ///< bound on the distance of the exact parameter
};

/// Returns the parameter of the point at which the edge from → to crosses the plane of a face. The error bound is
/// infinite if the edge may be parallel to the plane.
///
/// Proof of the bound: with distances a and b of the edge's ends, of errors e and f, d = a − b rounded, u = 2^-53, and
/// exact values A, B and D = A − B, |D − d| ≤ e + f + u |d|. From a/d − A/D = ((a/d) (D − d) + a − A) / D follows
/// |a/d − A/D| ≤ (|a/d| (e + f + u |d|) + e) / |D|, and the rounded quotient is off by u |a/d| more.
inline RoundedParameter rounded_parameter(const Vec3d& from, const Vec3d& to, const FaceCorners& face) {
    constexpr double u = 0x1p-53, above = 1 + 0x1p-40;
    const FilteredPlane plane(face);
    const auto a = plane.distance(from), b = plane.distance(to);
    const double all = a.value - b.value, of_all = a.error + b.error + u * std::abs(all);
    const double least = (1 - 0x1p-40) * (std::abs(all) - above * of_all);
    if (!(least > 0)) return {};
    const double t = a.value / all;
    const double error = above * ((std::abs(t) * of_all + a.error) / least + u * std::abs(t)) + 0x1p-1000;
    return error < 1 ? RoundedParameter{t, error} : RoundedParameter{};
}

/// Number with a bound on its error.
struct RoundedNumber {
    double value, error;

    /// Returns the number at a parameter, x from `from` to `to`, of which both err by at most `error_of_ends`. The
    /// error is infinite or NaN if the parameter's is infinite.
    static RoundedNumber between(double from, double to, const RoundedParameter& t, double error_of_ends = 0) {
        const double size = std::abs(to - from);
        return {from + t.value * (to - from),
                (1 + 0x1p-40) * (t.error * size + 3 * error_of_ends) + 0x1p-50 * (std::abs(from) + size) + 0x1p-1000};
    }
    /// True if the exact number is certainly within [low, high].
    bool is_within(double low, double high) const { return value - error >= low && value + error <= high; }
};

}  // namespace crumple
