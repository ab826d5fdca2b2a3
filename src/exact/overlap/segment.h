#pragma once

// Segments in which faces of two surfaces cross, without coordinates: each end is identified by the edge and the face
// that cross there. Sums of any type of number are computed from segments. The second surface is shifted
// infinitesimally, in each of two opposite directions (face_crossing.h). Compiled for host and device.

#include <cstddef>
#include <cstdint>

#include "exact/overlap/crossing.h"

namespace crumple {

/// End of a segment: the point at which an edge of one face crosses the other.
struct SegmentEnd {
    std::uint8_t side = 0;    ///< 0: an edge of a, 1: of b
    std::uint8_t edge = 0;    ///< 0, 1 or 2: the edge 01, 12 or 20 of its face, from corner to corner
    std::int8_t vertex = -1;  ///< corner of the edge's face if the end lies exactly at it, else −1
    std::int8_t jump = 0;     ///< change of the other surface's winding number along the edge, 1 or −1
};

/// Segment in which two faces a and b cross. On a, the inside of b's surface is to its left. On b, it is traversed from
/// end to start.
struct Segment {
    std::int32_t a = 0, b = 0;  ///< ids of the two faces
    SegmentEnd start, end;
    bool in_volume = true;  ///< true if it counts in the volume, which is computed for the forward shift only
    /// Number of times that it counts in sums over curves, which add up both shifts: 2 if both shifts have it.
    std::int8_t times = 1;
    bool summed = false;  ///< true if its terms are in the sums of a device
};

/// Returns the number of times that a segment of one shift counts in sums over curves. `tied`: true if the other shift
/// may have a different segment (DecidedCrossings).
CRUMPLE_HD constexpr int times_in_curves(bool tied) { return tied ? 1 : 2; }

/// Returns the segment in which two faces cross. at_vertex(side, edge) returns the corner for SegmentEnd::vertex.
template <class AtVertex>
CRUMPLE_HD Segment segment_of(const FaceCrossing& jumps, AtVertex at_vertex) {
    Segment segment;
    for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t edge = 0; edge < 3; ++edge) {
            const int jump = side == 0 ? jumps.a[edge] : jumps.b[edge];
            if (jump == 0) continue;
            const bool ends = (jump > 0) == (side == 0);
            SegmentEnd& end = ends ? segment.end : segment.start;
            end.side = static_cast<std::uint8_t>(side);
            end.edge = static_cast<std::uint8_t>(edge);
            end.vertex = static_cast<std::int8_t>(at_vertex(side, edge));
            end.jump = static_cast<std::int8_t>(jump);
        }
    return segment;
}

/// Crossing of two faces under one shift, without coordinates.
struct DecidedCrossing {
    FaceCrossing jumps;
    Segment segment;  ///< valid if jumps.segment
};

/// Crossings of two faces under each shift.
struct DecidedCrossings {
    DecidedCrossing forward, backward;
    bool tied = false;      ///< true if the two crossings may differ
    bool coplanar = false;  ///< true if both faces are nondegenerate and lie in one plane
};

/// Decides how two faces cross under each shift. `Signs` provides what cross_faces() requires; set(shift); vertex(side,
/// edge) for segment_of(); `tied`, true if some sign came from the shift; and in_plane_of_b(i), true if corner i of a
/// lies in the plane of b, if b has one.
template <class Signs>
CRUMPLE_HD DecidedCrossings decide_crossings(Signs& signs) {
    const auto decide = [&](Shift shift) {
        signs.set(shift);
        DecidedCrossing crossing;
        crossing.jumps = cross_faces(signs);
        if (crossing.jumps.segment)
            crossing.segment =
                segment_of(crossing.jumps, [&](auto side, auto edge) { return signs.vertex(side, edge); });
        return crossing;
    };
    DecidedCrossings both;
    both.forward = both.backward = decide(Shift::forward);
    both.tied = signs.tied;
    if (!both.tied) return both;
    both.backward = decide(Shift::backward);
    both.coplanar = signs.has_inside_a && signs.has_inside_b && signs.in_plane_of_b(0) && signs.in_plane_of_b(1) &&
                    signs.in_plane_of_b(2);
    return both;
}

}  // namespace crumple
