#pragma once

// Edge at which a segment ends (segment.h), with the coordinates from which the point is computed. Compiled for host
// and device.

#include "exact/overlap/segment.h"

namespace crumple {

/// Edge on which a segment ends, and the face that it crosses there. If the segment ends at a vertex, `from` and `to`
/// are that vertex.
struct CrossingEdge {
    Vec3d from, to;
    FaceCorners face;

    /// `a`, `b`: corners of the segment's faces.
    CRUMPLE_HD CrossingEdge(const FaceCorners& a, const FaceCorners& b, const SegmentEnd& end)
        : face(end.side ? a : b) {
        const FaceCorners& of = end.side ? b : a;
        from = of[end.edge];
        to = of[next_corner(end.edge)];
        if (end.vertex >= 0) from = to = of[static_cast<std::size_t>(end.vertex)];
    }
    CRUMPLE_HD bool is_vertex() const { return from == to; }
};

/// True if a segment runs from a vertex to the same position, as most do where many faces meet at common vertices. Its
/// cones, and its terms in sums over curves, are 0.
CRUMPLE_HD inline bool has_no_length(const CrossingEdge& start, const CrossingEdge& end) {
    return start.is_vertex() && end.is_vertex() && start.from == end.from;
}

}  // namespace crumple
