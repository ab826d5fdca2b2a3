#pragma once

// Cuts a triangle along segments that lie in it into convex pieces, for pictures: in float64, not exactly.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vec.h"

namespace crumple::io {

using CutSegment = std::array<Vec3d, 2>;

/// Convex piece of a triangle: the indices of its corners, in the same orientation as those of the triangle.
using CutPiece = std::vector<std::int32_t>;

/// Returns the pieces of the triangle. No segment passes through the inside of a piece. A cut may continue beyond the
/// end of its segment, to the border of the piece in which the segment ends. New corners are appended to `points`.
/// Cost: O(segments x pieces).
std::vector<CutPiece> cut_triangle(std::vector<Vec3d>& points, const std::array<std::int32_t, 3>& corners,
                                   std::span<const CutSegment> segments);

}  // namespace crumple::io
