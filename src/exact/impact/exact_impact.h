#pragma once

// Decides when two moving features first touch, in exact arithmetic for every finite float64 coordinate: the reference
// for all faster decisions, and their fallback. The derivation is in docs/motion_algebra.md. Host only.
//
// A face is the convex hull of its three points at each t, and an edge that of its two points, degenerate or not.
// Points move independently of each other. Equal points and static points are allowed.
//
// Cost: 5 to 40 us for ordinary coordinates, about 10 ms if magnitudes span the range of float64.

#include "exact/impact/impact.h"

namespace crumple {

/// Decides the impact of vertex p and face a b c.
Impact vertex_face(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c);

/// Decides the impact of edges a b and c d.
Impact edge_edge(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d);

/// Decides the impact of vertex p and edge a b.
Impact vertex_edge(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b);

/// Decides the impact of vertices p and q.
Impact vertex_vertex(const MovingPoint& p, const MovingPoint& q);

}  // namespace crumple
