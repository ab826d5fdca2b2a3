#pragma once

// When two moving features first touch, decided in exact arithmetic for every finite float64 coordinate: the yardstick
// for everything faster, and what that falls back on. The derivation is docs/motion_algebra.md. Host only.
//
// A face is the convex hull of its three points at each t, an edge that of its two, whether or not they collapse.
// Points move independently of each other; equal points, and points at rest, are as good as any.
//
// Cost: 5 to 40 us for ordinary coordinates, some 10 ms where magnitudes span the range of float64.

#include "exact/impact/impact.h"

namespace crumple {

/// Vertex p against the face a b c.
Impact vertex_face(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c);

/// Edge a b against edge c d.
Impact edge_edge(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d);

/// Vertex p against the edge a b.
Impact vertex_edge(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b);

/// Vertex p against vertex q.
Impact vertex_vertex(const MovingPoint& p, const MovingPoint& q);

}  // namespace crumple
