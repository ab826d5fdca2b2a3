#pragma once

// Two moving features as three vectors between their points, linear in time, in float64. Compiled for host and device.
// Bounds are derived in docs/motion_filters.md.
//
// A vertex p and a face a b c are the vectors u = b - a, v = c - a, w = p - a; edges a b and c d are u = b - a,
// v = d - c, w = c - a. Whenever the features touch, (u x v) . w = 0.

#include <array>

#include "exact/impact/impact.h"
#include "geometry/predicates.h"

namespace crumple {

enum class FeaturePair { vertex_face, edge_edge };

/// Points p a b c of a vertex and a face, or a b c d of two edges.
using FourPoints = std::array<MovingPoint, 4>;

/// Returns u, v and w, each computed by difference(to, from) from two points.
template <FeaturePair pair, class Difference>
CRUMPLE_HD inline auto vectors(const FourPoints& x, Difference difference) {
    if constexpr (pair == FeaturePair::vertex_face) {
        const auto& [p, a, b, c] = x;
        return std::array{difference(b, a), difference(c, a), difference(p, a)};
    } else {
        const auto& [a, b, c, d] = x;
        return std::array{difference(b, a), difference(d, c), difference(c, a)};
    }
}

/// Vector that changes linearly from `start` to `end`. Each component of both has one rounding error.
struct MovingVector {
    Vec3d start, end;

    /// Returns bounds on the components' magnitudes at any time.
    CRUMPLE_HD Vec3d reach() const { return max(abs(start), abs(end)); }
    /// Returns the sum of all magnitudes; NaN if one of them is NaN.
    CRUMPLE_HD double sum() const {
        const Vec3d all = abs(start) + abs(end);
        return all.x + all.y + all.z;
    }
    /// Returns the vector at time t. Each component is off by at most four roundings, relative to reach().
    CRUMPLE_HD Vec3d at(double t) const { return (1 - t) * start + t * end; }
};

/// Returns, for each component of a x b, the sum of its two products instead of their difference. Components of a and b
/// must not be negative.
CRUMPLE_HD inline Vec3d cross_magnitude(const Vec3d& a, const Vec3d& b) {
    return {a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x};
}

template <FeaturePair pair>
struct Approach {
    MovingVector u, v, w;
    Vec3d extent_u, extent_v, extent_w;
    double reach;      ///< sum of the magnitudes of all components of u, v and w at both ends, rounded
    double slack;      ///< exceeds the underflow error of anything computed from the vectors
    double magnitude;  ///< bounds the sum of the magnitudes of the monomials of (u x v) . w

    CRUMPLE_HD explicit Approach(const FourPoints& points)
        : Approach(vectors<pair>(points, [](const MovingPoint& to, const MovingPoint& from) {
              return MovingVector{to.start - from.start, to.end - from.end};
          })) {}

    /// True if nothing overflows and no component is NaN.
    CRUMPLE_HD bool in_range() const { return reach < 0x1p200; }

   private:
    CRUMPLE_HD explicit Approach(const std::array<MovingVector, 3>& x)
        : u(x[0]),
          v(x[1]),
          w(x[2]),
          extent_u(u.reach()),
          extent_v(v.reach()),
          extent_w(w.reach()),
          reach(u.sum() + v.sum() + w.sum()),
          slack(0x1p-1022 * (1 + reach) * (1 + reach)),
          magnitude(dot(cross_magnitude(extent_u, extent_v), extent_w)) {}
};

}  // namespace crumple
