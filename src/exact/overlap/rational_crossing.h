#pragma once

// Crosses two faces of closed surfaces under a shift in rational arithmetic, for every finite float64 coordinate: the
// reference for everything faster, and its fallback. Host only.

#include <array>

#include <boost/multiprecision/cpp_int.hpp>

#include "exact/integer.h"
#include "exact/overlap/crossing.h"
#include "exact/overlap/segment.h"

namespace crumple {

using Rational = mp::cpp_rational;
using IntegerTriangle = std::array<Vec3<Integer>, 3>;

using RationalCrossing = Crossing<Rational>;

/// b is shifted. Both triangles in one unit. Cost: some 20 us for ordinary coordinates.
RationalCrossing cross_rationally(const IntegerTriangle& a, const IntegerTriangle& b, Shift shift);

RationalCrossing cross_rationally(const FaceCorners& a, const FaceCorners& b, Shift shift);

/// Decides how two faces cross, for every finite coordinate.
DecidedCrossings decide_crossings(const FaceCorners& a, const FaceCorners& b);

/// The share of its way after which an edge crosses the plane of a face.
Rational share_of_edge(const Vec3d& from, const Vec3d& to, const FaceCorners& face);

/// Returns the share of a face in the winding number of its surface at p: ±1 if the ray from p along +x meets it. The
/// surface is shifted. In one unit.
int winding_along_ray(const Vec3<Integer>& p, const IntegerTriangle& face, Shift shift);
int winding_along_ray(const Vec3d& p, const FaceCorners& face, Shift shift);

}  // namespace crumple
