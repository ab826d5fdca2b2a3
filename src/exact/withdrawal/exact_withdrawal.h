#pragma once

// How far one triangle has to move along a direction until it is past another one, in integers, for every finite
// float64 coordinate: the reference for the filter (filtered_withdrawal.h), and its fallback. Host only.

#include <optional>

#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/face_crossing.h"

namespace crumple {

/// Returns the greatest t, in units of `direction`, such that a and b + t · direction have a common point; it may be
/// negative. Returns nothing if there is no such t. Triangles are closed, and may be degenerate. `direction`: finite,
/// not 0. Cost: about 20 us for ordinary coordinates.
std::optional<Rational> withdrawal_rationally(const FaceCorners& a, const FaceCorners& b, const Vec3d& direction);

/// Returns the least float64 that is at least x: infinity if x exceeds all finite ones. Cost: some microseconds.
double rounded_up(const Rational& x);

}  // namespace crumple
