#pragma once

// When two moving features first come within a given distance, decided in exact arithmetic for every finite float64
// coordinate and distance. The derivation is docs/motion_algebra.md. Host only.
//
// Features are those of rational_impact.h. Here `meets` says that their distance is at most that of the separation at
// some t in [0, 1], `toi` is the first such t, and `start` says that it is 0. Without a separation, or with a share of
// no distance, the answers are those of rational_impact.h. With Separation::approaching_only, `toi` of features that
// are that close at the start is the greatest lower bound of the times at which they are closer still.
//
// Cost: 60 to 200 us for ordinary coordinates, half a second where magnitudes span the range of float64.

#include "exact/impact/impact.h"
#include "exact/impact/min_distance.h"

namespace crumple {

/// Vertex p against the face a b c.
Impact vertex_face(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                   const Separation& separation);

/// Edge a b against edge c d.
Impact edge_edge(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                 const Separation& separation);

/// Vertex p against the edge a b.
Impact vertex_edge(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const Separation& separation);

/// Vertex p against vertex q.
Impact vertex_vertex(const MovingPoint& p, const MovingPoint& q, const Separation& separation);

}  // namespace crumple
