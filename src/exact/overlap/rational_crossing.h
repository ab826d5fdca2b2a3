#pragma once

// How two faces of closed surfaces cross under a shift, and what that says of winding numbers, in rational arithmetic:
// for every finite float64 coordinate. The yardstick for everything faster, and what that falls back on. Host only.

#include <array>

#include <boost/multiprecision/cpp_int.hpp>

#include "exact/integer.h"
#include "exact/overlap/face_crossing.h"

namespace crumple {

using Rational = mp::cpp_rational;
using IntegerTriangle = std::array<Vec3<Integer>, 3>;

/// For the winding number w of the other surface on a face of area |f|, and the hat functions φ_k of its corners:
/// 3 ∫ w φ_k dA / |f|. So a face on which w is constant has three times w.
using RationalWeights = std::array<Rational, 3>;

/// Where a crossing is: barycentric coordinates in both faces.
struct CrossingPoint {
    std::array<Rational, 3> in_a, in_b;
};

struct RationalCrossing {
    FaceCrossing jumps;
    /// The segment in which the faces cross, if there is one: seen on a, what is inside b's surface is on its left.
    CrossingPoint start, end;
    /// What the crossing adds to the weights of each face, if there is a segment; else 0.
    RationalWeights a{}, b{};
};

/// b is shifted. Both triangles in one unit. Cost: some 20 us for ordinary coordinates.
RationalCrossing cross_rationally(const IntegerTriangle& a, const IntegerTriangle& b, Shift shift);

/// What a face adds to the winding number of its surface at p: ±1 if the ray from p along +x meets it. The surface is
/// shifted. In one unit.
int winding_along_ray(const Vec3<Integer>& p, const IntegerTriangle& face, Shift shift);

}  // namespace crumple
