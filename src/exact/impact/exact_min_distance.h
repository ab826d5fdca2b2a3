#pragma once

// Decides when two moving features first come within a minimum distance, in exact arithmetic for every finite float64
// coordinate and distance. The derivation is in docs/motion_algebra.md. Host only.
//
// Features are those of exact_impact.h. Here `meets` is true if their distance is at most the minimum distance at
// some t in [0, 1], `toi` is the first such t, rounded down, and `start` is true if this t is 0. If the minimum
// distance is 0, results are those of exact_impact.h. With MinDistance::approaching_only, `toi` of features that
// start within the minimum distance is the greatest lower bound of the times at which they are closer than at the
// start.
//
// Cost: 60 to 200 us for ordinary coordinates, half a second if magnitudes span the range of float64.

#include "exact/impact/impact.h"
#include "exact/impact/min_distance.h"

namespace crumple {

/// Decides vertex p and face a b c.
Impact vertex_face(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                   const MinDistance& separation);

/// Decides edges a b and c d.
Impact edge_edge(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                 const MinDistance& separation);

/// Decides vertex p and edge a b.
Impact vertex_edge(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MinDistance& separation);

/// Decides vertices p and q.
Impact vertex_vertex(const MovingPoint& p, const MovingPoint& q, const MinDistance& separation);

}  // namespace crumple
