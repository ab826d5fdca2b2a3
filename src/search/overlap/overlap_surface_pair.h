#pragma once

// Input of the sums over an overlap: two bodies, faces with the number of times that they count, and the ends of the
// segments in which faces cross. Host only.

#include <array>

#include "exact/overlap/segment.h"
#include "search/overlap/overlap_windings.h"

namespace crumple {

/// Surfaces of two bodies under their poses, and the origin of the sums over their overlap.
struct SurfacePair {
    std::array<const PlacedSurface*, 2> surface{};
    Vec3d origin;

    bool in_range() const { return surface[0]->in_range && surface[1]->in_range; }
    FaceCorners corners(std::size_t side, std::int32_t face) const { return surface[side]->corners(face); }
    FaceCorners corners_a(const Segment& s) const { return corners(0, s.a); }
    FaceCorners corners_b(const Segment& s) const { return corners(1, s.b); }
};

/// Face, and the number of times that it counts in the sums, which may be negative.
struct CountedFace {
    std::int32_t face, times;
};

/// Edge on which a segment ends, and the face that it crosses there. If the segment ends at a vertex, `from` and `to`
/// are that vertex.
struct CrossingEdge {
    Vec3d from, to;
    FaceCorners face;

    CrossingEdge(const SurfacePair& surfaces, const Segment& segment, const SegmentEnd& end) {
        const FaceCorners a = surfaces.corners_a(segment), b = surfaces.corners_b(segment);
        const FaceCorners& of = end.side ? b : a;
        face = end.side ? a : b;
        from = of[end.edge];
        to = of[next_corner(end.edge)];
        if (end.vertex >= 0) from = to = of[static_cast<std::size_t>(end.vertex)];
    }
    bool is_vertex() const { return from == to; }
};

/// True if a segment runs from a vertex to the same position, so that its cones and its terms in sums over curves are
/// 0. So do most segments where many faces meet at common vertices.
inline bool has_no_length(const CrossingEdge& start, const CrossingEdge& end) {
    return start.is_vertex() && end.is_vertex() && start.from == end.from;
}

}  // namespace crumple
