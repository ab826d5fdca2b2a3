#pragma once

// Exact decision for pairs with at least one degenerate triangle: a segment, or a point as a segment of length 0. Such
// a triangle has one edge, the segment, and no inside. Compiled for host and device; `Signs` is ExactSigns.
//
// Points of a line are ordered along it as they are lexicographically, which needs comparisons only. Signs relative to
// lines and planes decide if two segments, or a segment and a triangle, have a point in common. If a pair has shared
// vertices, their hull H is a part of the segment. The intersection is convex, so it exceeds H iff the other triangle
// extends beyond an end of H, towards the end of the segment on that side (proofs: docs/narrow.md).

#include "exact/intersection/arrangement.h"

namespace crumple {

/// True if p comes before q in lexicographic order.
CRUMPLE_HD inline bool precedes(const Vec3d& p, const Vec3d& q) {
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
}

/// Hull of some points on one line, by its ends.
struct CollinearHull {
    Vec3d first, last;

    CRUMPLE_HD explicit CollinearHull(const Vec3d& p) : first(p), last(p) {}
    CRUMPLE_HD explicit CollinearHull(const Triangle& t) : CollinearHull(t.point[0]) {
        add(t.point[1]);
        add(t.point[2]);
    }
    CRUMPLE_HD void add(const Vec3d& p) {
        if (precedes(p, first)) first = p;
        if (precedes(last, p)) last = p;
    }
    CRUMPLE_HD bool is_point() const { return first == last; }
};

template <class Signs>
CRUMPLE_HD_COLD bool collinear(const Vec3d& p, const Vec3d& q, const Vec3d& r, Signs& signs) {
    if (p == q || p == r || q == r) return true;
    for (int axis = 0; axis < 3; ++axis)
        if (orient2d_filtered(p, q, r, axis) != undecided) return false;  // the filter never returns 0
    return signs.turn(p, q, r, 0) == 0 && signs.turn(p, q, r, 1) == 0 && signs.turn(p, q, r, 2) == 0;
}

/// Returns an axis along which the projection of a nondegenerate triangle is not degenerate.
template <class Signs>
CRUMPLE_HD int axis_of_area(const Vec3d& p, const Vec3d& q, const Vec3d& r, Signs& signs) {
    return signs.turn(p, q, r, 0) != 0 ? 0 : signs.turn(p, q, r, 1) != 0 ? 1 : 2;
}

/// True if the axis-aligned boxes of two triangles are disjoint.
CRUMPLE_HD inline bool boxes_apart(const Triangle& a, const Triangle& b) {
    const Vec3d low_a = min(a.point[0], min(a.point[1], a.point[2])),
                high_b = max(b.point[0], max(b.point[1], b.point[2]));
    const Vec3d low_b = min(b.point[0], min(b.point[1], b.point[2])),
                high_a = max(a.point[0], max(a.point[1], a.point[2]));
    return low_a.x > high_b.x || low_a.y > high_b.y || low_a.z > high_b.z || low_b.x > high_a.x || low_b.y > high_a.y ||
           low_b.z > high_a.z;
}

/// True if two segments have a point in common.
template <class Signs>
CRUMPLE_HD bool segments_meet(CollinearHull s, CollinearHull t, Signs& signs) {
    if (s.is_point()) swap_values(s, t);
    const auto& [p, q] = s;
    const bool first_on_line = collinear(p, q, t.first, signs);
    if (first_on_line && collinear(p, q, t.last, signs)) return !precedes(q, t.first) && !precedes(t.last, p);
    if (signs.orient(p, q, t.first, t.last) != 0) return false;
    // In a projection of their plane that keeps areas nonzero, each segment's line must separate the other's ends, or
    // contain one of them.
    const int axis = axis_of_area(p, q, first_on_line ? t.last : t.first, signs);
    return signs.turn(p, q, t.first, axis) * signs.turn(p, q, t.last, axis) <= 0 &&
           signs.turn(t.first, t.last, p, axis) * signs.turn(t.first, t.last, q, axis) <= 0;
}

/// True if a segment in the plane of a nondegenerate triangle meets it. If the two are disjoint, the line through an
/// edge of one has all of the other strictly on one side; for an edge of the triangle, on the outer side.
template <class Signs>
CRUMPLE_HD bool segment_meets_triangle_in_plane(const CollinearHull& s, const std::array<Vec3d, 3>& t, Signs& signs) {
    const Vec3d p = s.first, q = s.last;
    const int axis = axis_of_area(t[0], t[1], t[2], signs), inside = signs.turn(t[0], t[1], t[2], axis);
    const auto outside = [&](const Vec3d& from, const Vec3d& to) {
        return signs.turn(from, to, p, axis) == -inside && signs.turn(from, to, q, axis) == -inside;
    };
    if (outside(t[0], t[1]) || outside(t[1], t[2]) || outside(t[2], t[0])) return false;
    const int side = signs.turn(p, q, t[0], axis);
    return side == 0 || signs.turn(p, q, t[1], axis) != side || signs.turn(p, q, t[2], axis) != side;
}

/// True if a segment meets a nondegenerate triangle; if `proper`, only if it crosses the inside strictly.
template <class Signs>
CRUMPLE_HD bool segment_meets_triangle(const CollinearHull& s, const std::array<Vec3d, 3>& t, bool proper,
                                       Signs& signs) {
    const auto& [p, q] = s;
    const int side_p = signs.orient(t[0], t[1], t[2], p), side_q = signs.orient(t[0], t[1], t[2], q);
    if (side_p * side_q > 0 || (proper && side_p * side_q == 0)) return false;
    if (side_p == 0 && side_q == 0) return segment_meets_triangle_in_plane(s, t, signs);
    // The segment's line pierces the plane in one point of the segment; the signs are those of the edges' turns about
    // that point.
    const int e01 = signs.orient(p, q, t[0], t[1]), e12 = signs.orient(p, q, t[1], t[2]);
    if (e01 * e12 < 0) return false;
    const int e20 = signs.orient(p, q, t[2], t[0]);
    if (proper) return e01 != 0 && e01 == e12 && e01 == e20;
    return e01 * e20 >= 0 && e12 * e20 >= 0;
}

/// True if a triangle contains points beyond its corner at `from` in the direction of `to`.
template <class Signs>
CRUMPLE_HD bool goes_on(const Triangle& t, bool degenerate, const Vec3d& from, const Vec3d& to, Signs& signs) {
    if (from == to) return false;
    if (degenerate) {
        for (const Vec3d& p : t.point) {
            if (p != from && precedes(from, p) == precedes(from, to) && collinear(from, to, p, signs)) return true;
        }
        return false;
    }
    const int corner = first({t.point[0] == from, t.point[1] == from, t.point[2] == from});
    const Vec3d r = point(t, after(corner)), s = point(t, before(corner));
    if (signs.orient(from, r, s, to) != 0) return false;
    const int axis = axis_of_area(from, r, s, signs), inside = signs.turn(from, r, s, axis);
    return signs.turn(from, r, to, axis) * inside >= 0 && signs.turn(from, to, s, axis) * inside >= 0;
}

/// True if the degenerate triangle d, whose corners marked in `shared` are shared, and the triangle t collide. At most
/// two distinct vertices may be shared, and not all corners of d.
template <class Signs>
CRUMPLE_HD_COLD bool degenerate_collide(const Triangle& d, const Marks& shared, const Triangle& t, bool t_degenerate,
                                        bool proper, Signs& signs) {
    const bool neighbours = shared[0] || shared[1] || shared[2];
    // A segment that crosses a triangle's plane strictly and contains a corner of the triangle crosses the plane at
    // this corner, and so no interior: a pair that shares a vertex is not proper.
    if (boxes_apart(d, t) || (proper && (t_degenerate || neighbours))) return false;
    const CollinearHull s(d);
    if (!neighbours) {
        return t_degenerate ? segments_meet(s, CollinearHull(t), signs)
                            : segment_meets_triangle(s, t.point, proper, signs);
    }
    CollinearHull hull(point(d, first(shared)));
    for (int i = 0; i < 3; ++i) {
        if (shared[static_cast<std::size_t>(i)]) hull.add(point(d, i));
    }
    return goes_on(t, t_degenerate, hull.first, s.first, signs) || goes_on(t, t_degenerate, hull.last, s.last, signs);
}

}  // namespace crumple
