#pragma once

// Vectors of double words (unevaluated sums of two float64 numbers) for distances. The errors of products and sums are
// bounded relative to the magnitudes of their terms, which is cheaper than a bound relative to the result. ε = 2^-53.
// Compiled for host and device.

#include "geometry/double_word.h"

namespace crumple::detail {

using Vec3dw = Vec3<DoubleWord>;

CRUMPLE_HD inline Vec3d high(const Vec3dw& p) { return {p.x.high, p.y.high, p.z.high}; }
CRUMPLE_HD inline double length_1(const Vec3d& p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z); }

/// Returns p - q, exactly.
CRUMPLE_HD inline Vec3dw exact_difference(const Vec3d& p, const Vec3d& q) {
    return {two_sum(p.x, -q.x), two_sum(p.y, -q.y), two_sum(p.z, -q.z)};
}

/// Returns w + s u, or w + s u + t v, along one axis, with an error of at most 16 ε² times the sum of the terms'
/// magnitudes.
CRUMPLE_HD inline DoubleWord combine(DoubleWord w, double s, DoubleWord u) {
    const TwoTerms su = two_product(s, u.high), sum = two_sum(w.high, su.high);
    return two_sum(sum.high, sum.low + (w.low + (su.low + s * u.low)));
}
CRUMPLE_HD inline DoubleWord combine(DoubleWord w, double s, DoubleWord u, double t, DoubleWord v) {
    const TwoTerms su = two_product(s, u.high), tv = two_product(t, v.high);
    const TwoTerms first = two_sum(w.high, su.high), both = two_sum(first.high, tv.high);
    const double low = w.low + ((su.low + s * u.low) + (tv.low + t * v.low));
    return two_sum(both.high, (first.low + both.low) + low);
}
CRUMPLE_HD inline Vec3dw combine(const Vec3dw& w, double s, const Vec3dw& u) {
    return {combine(w.x, s, u.x), combine(w.y, s, u.y), combine(w.z, s, u.z)};
}
CRUMPLE_HD inline Vec3dw combine(const Vec3dw& w, double s, const Vec3dw& u, double t, const Vec3dw& v) {
    return {combine(w.x, s, u.x, t, v.x), combine(w.y, s, u.y, t, v.y), combine(w.z, s, u.z, t, v.z)};
}

/// Returns p · q, with an error of at most 24 ε² times the sum of the magnitudes of its three products.
CRUMPLE_HD inline DoubleWord dot_product(const Vec3dw& p, const Vec3dw& q) {
    const TwoTerms x = two_product(p.x.high, q.x.high), y = two_product(p.y.high, q.y.high),
                   z = two_product(p.z.high, q.z.high);
    const TwoTerms xy = two_sum(x.high, y.high), xyz = two_sum(xy.high, z.high);
    const double low_x = x.low + (p.x.high * q.x.low + p.x.low * q.x.high),
                 low_y = y.low + (p.y.high * q.y.low + p.y.low * q.y.high),
                 low_z = z.low + (p.z.high * q.z.low + p.z.low * q.z.high);
    return two_sum(xyz.high, (xy.low + xyz.low) + ((low_x + low_y) + low_z));
}

}  // namespace crumple::detail
