#pragma once

// Joins the segments in which two surfaces cross to curves. Host only.
//
// Segments end where an edge of one surface crosses a face of the other. At an ordinary edge two faces meet, so that
// the segment on one of them ends where that on the other one starts. At an edge of more faces, segments of faces are
// joined between which a solid would lie: so curves touch there instead of crossing each other.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "exact/overlap/segment.h"

namespace crumple {

/// The corners of a face of the first or the second surface: its vertices, and where they are.
struct FaceOfSurface {
    std::array<std::int32_t, 3> vertex;
    FaceCorners corner;
};

struct JoinedCurve {
    std::vector<std::int32_t> segments;  ///< indices, in the order in which they follow each other
    bool closed = false;                 ///< the last segment ends where the first one starts
};

/// `segments`: those of one shift. The segments from index `links` on belong to degenerate faces, whose edges lie on
/// each other and cross the same face: they have no length, join curves, and are left out of these. Curves are in the
/// order of their lowest segments; closed ones start with it. A curve is open where an edge belongs to one face alone,
/// or to faces that are not oriented alike. O(n log n).
std::vector<JoinedCurve> join_segments(std::span<const Segment> segments, std::size_t links,
                                       const std::function<FaceOfSurface(std::size_t side, std::int32_t face)>& face);

}  // namespace crumple
