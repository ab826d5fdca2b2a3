#pragma once

// Segments in which faces of two surfaces cross: which edges end on which faces, without numbers. What sums are made
// of, for any type of number. Compiled for host and device.

#include <cstddef>
#include <cstdint>

#include "exact/overlap/crossing.h"

namespace crumple {

/// End of a segment: the point at which an edge of one face crosses the other.
struct SegmentEnd {
    std::uint8_t side = 0;    ///< 0: an edge of a, 1: of b
    std::uint8_t edge = 0;    ///< 01, 12 or 20
    std::int8_t vertex = -1;  ///< the corner of that face at which it is exactly, or −1
    std::int8_t jump = 0;     ///< change of the winding number along the edge
};

/// On a, the inside of b's surface is on the left of the segment; on b, it runs from end to start.
struct Segment {
    std::int32_t a = 0, b = 0;  ///< faces
    SegmentEnd start, end;
    bool in_volume = true;  ///< it counts in the volume: that is of one shift
    std::int8_t times = 1;  ///< how often it counts in curves: twice if both shifts have it
};

/// The segment of faces that cross. `at_vertex(side, edge)`: the corner at which that edge crosses exactly, or −1.
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

/// How two faces cross, without numbers.
struct DecidedCrossing {
    FaceCrossing jumps;
    Segment segment;  ///< if jumps.segment
};

/// The same under either shift.
struct DecidedCrossings {
    DecidedCrossing forward, backward;
    bool tied = false;      ///< they may differ
    bool coplanar = false;  ///< both faces lie in one plane, and have an inside
};

/// `Signs` is what cross_faces() asks for, and has set(shift), vertex(side, edge) for segment_of(), `tied`: whether
/// some sign was that of the shift, and in_plane_of_b(i): whether corner i of a lies in the plane of b, if b has one.
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
