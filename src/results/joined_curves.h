#pragma once

// Joins segments into curves. A segment is the line in which a face of one surface crosses a face of the other. Host
// only.
//
// Segments end where an edge of one surface crosses a face of the other. At an ordinary edge two faces meet, so that
// the segment on one of them ends where the segment on the other one starts. At an edge with more faces, two segments
// are joined if a solid would lie between their faces, so that curves touch there instead of crossing each other.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "exact/overlap/segment.h"

namespace crumple {

/// Corners of a face of the first or the second surface: vertices and positions.
struct FaceOfSurface {
    std::array<std::int32_t, 3> vertex;
    FaceCorners corner;
};

using FaceReader = std::function<FaceOfSurface(std::size_t side, std::int32_t face)>;

struct JoinedCurve {
    std::vector<std::int32_t>
        segments;         ///< indices of segments, in the order along the curve; without the links of join_segments()
    bool closed = false;  ///< true if the last segment ends where the first one starts
};

/// Joins segments, all of the same shift (exact/overlap/face_crossing.h), into curves. Segments from index `links` on
/// belong to degenerate faces, whose edges coincide and cross the same face: such segments have no length, and connect
/// other segments without being listed in curves. Curves are in the order of their lowest segments; closed ones start
/// with it. A curve ends (is open) at an edge that belongs to one face alone, or to faces that are not oriented alike.
/// O(n log n).
std::vector<JoinedCurve> join_segments(std::span<const Segment> segments, std::size_t links, const FaceReader& face);

}  // namespace crumple
