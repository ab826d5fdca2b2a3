#pragma once

// Lengths of vectors in float32 that are not too short because squares underflow. Compiled for host and device.

#include "geometry/vec.h"

namespace crumple {

/// Added to the square of a length: more than what its squares and sums lose where they underflow (docs/features.md).
inline constexpr float least_square = 1e-36f;

/// The length of v, however short v is: too long by up to 1e-18, too short by no more than 3 u of it.
CRUMPLE_HD inline float length(const Vec3f& v) { return std::sqrt(dot(v, v) + least_square); }

}  // namespace crumple
