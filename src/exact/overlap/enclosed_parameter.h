#pragma once

// Parameter at which an edge crosses the plane of a face, in double-double arithmetic with an error bound. Host only.

#include "exact/overlap/enclosed_terms.h"
#include "exact/overlap/exact_crossing.h"

namespace crumple {

/// Returns the double-double number nearest to x, with an error bound.
inline Enclosed enclosed(const Rational& x) {
    const auto high = x.convert_to<double>();
    const Rational rest = x - Rational(high);
    const auto low = rest.convert_to<double>();
    const Rational beyond = abs(rest - Rational(low));
    const TwoTerms value = two_sum(high, low);
    return {value, beyond == 0 ? 0 : (1 + 0x1p-40) * beyond.convert_to<double>() + 0x1p-1070};
}

/// Returns the parameter in [0, 1] at which the edge from → to crosses the plane of a face, for coordinates in the
/// range of double-double arithmetic.
inline Enclosed enclosed_parameter(const Vec3d& edge_from, const Vec3d& edge_to, const FaceCorners& q) {
    const Enclosed parameter = filtered_parameter(edge_from, edge_to, q);
    return std::isfinite(parameter.error) ? parameter : enclosed(edge_parameter(edge_from, edge_to, q));
}

}  // namespace crumple
