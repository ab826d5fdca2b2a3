#pragma once

// Length of vectors in float32, with a bound on the error even if squares underflow. Compiled for host and device.

#include "geometry/vec.h"

namespace crumple {

/// Added to the square of a length: exceeds what squares and sums lose by underflow (docs/features.md).
inline constexpr float least_square = 1e-36f;

/// Returns the length of v, however short v is: too long by at most 1e-18, too short by at most 3 u of it.
CRUMPLE_HD inline float length(const Vec3f& v) { return std::sqrt(dot(v, v) + least_square); }

}  // namespace crumple
