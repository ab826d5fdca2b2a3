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

}  // namespace crumple
