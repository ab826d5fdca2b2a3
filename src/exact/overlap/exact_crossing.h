#pragma once

// Computes crossings of two faces of closed surfaces in rational arithmetic, for every finite float64 coordinate: the
// reference for all faster versions, and their fallback. The second surface is shifted infinitesimally, which decides
// ties (Shift in face_crossing.h). Host only.

#include <array>

#include <boost/multiprecision/cpp_int.hpp>

#include "exact/integer.h"
#include "exact/overlap/crossing.h"
#include "exact/overlap/segment.h"

namespace crumple {

using Rational = mp::cpp_rational;
using IntegerTriangle = std::array<Vec3<Integer>, 3>;

using RationalCrossing = Crossing<Rational>;

/// Computes the crossing of a and b, with b shifted. The integer coordinates of both triangles must be in the same
/// unit. Cost: about 20 us for ordinary coordinates.
RationalCrossing cross_rationally(const IntegerTriangle& a, const IntegerTriangle& b, Shift shift);

RationalCrossing cross_rationally(const FaceCorners& a, const FaceCorners& b, Shift shift);

/// Decides how two faces cross under each shift, for every finite coordinate.
DecidedCrossings decide_crossings(const FaceCorners& a, const FaceCorners& b);

/// Returns the parameter at which the edge from → to crosses the plane of a face: 0 at `from`, 1 at `to`.
Rational edge_parameter(const Vec3d& from, const Vec3d& to, const FaceCorners& face);

/// Returns the contribution of a face to the winding number of its surface at p: ±1 if the ray from p along +x meets
/// the face, otherwise 0. The surface is shifted, the point is not. The coordinates of both must be in the same unit.
int winding_along_ray(const Vec3<Integer>& p, const IntegerTriangle& face, Shift shift);
int winding_along_ray(const Vec3d& p, const FaceCorners& face, Shift shift);

}  // namespace crumple
