#pragma once

// Integrals over the overlap of two closed surfaces as sums over their faces, in rational arithmetic (docs/overlap.md).
// Host only.

#include "exact/overlap/rational_crossing.h"

namespace crumple {

/// Sums over faces with corners p0, p1, p2, normal N = (p1 - p0) × (p2 - p0), and weights m whose sum is f, of the
/// winding number of the other surface. In units of the faces' coordinates.
struct RationalSums {
    Rational volume;        ///< Σ det(p0, p1, p2) f = 18 V, over the faces of both
    Vec3<Rational> moment;  ///< Σ det(p0, p1, p2) (m0 p0 + m1 p1 + m2 p2) = 24 ∫ x, over the faces of both
    Vec3<Rational> area;    ///< Σ N f = 6 S, over the faces of the first
    Vec3<Rational> torque;  ///< Σ (m0 p0 + m1 p1 + m2 p2) × N = 6 T about the origin, over the faces of the first

    void add(const IntegerTriangle& face, const FaceWeights<Rational>& weights, bool of_first);
};

}  // namespace crumple
