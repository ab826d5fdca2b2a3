#pragma once

// Decides if two features touch at the start: quickly if two vertices coincide, otherwise by exact predicates, which
// need some kilobytes of stack. Compiled for host and device.

#include "exact/impact/approach.h"

namespace crumple {
namespace detail {

/// Returns an axis along which the projection of a b c or of b c d is certainly not degenerate, or −1. Along this axis
/// the plane of the four points is not projected to a line.
CRUMPLE_HD inline int axis_of_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    for (int axis = 0; axis < 3; ++axis) {
        if (orient2d_filtered(a, b, c, axis) != undecided || orient2d_filtered(b, c, d, axis) != undecided) return axis;
    }
    return -1;
}

}  // namespace detail

/// True if a vertex of one feature coincides with a vertex of the other at the start.
template <FeaturePair pair>
CRUMPLE_HD inline bool vertices_touch_at_start(const FourPoints& points) {
    const Vec3d a = points[0].start, b = points[1].start, c = points[2].start, d = points[3].start;
    return a == c || a == d || (pair == FeaturePair::vertex_face ? a == b : b == c || b == d);
}

/// Decides by exact predicates whether the features touch at the start: 1 if they do, -1 if they do not, 0 if a
/// coordinate is beyond the range of expansions (0, or 2^-300 to 2^300 in magnitude), or if points may be on one line.
template <FeaturePair pair>
CRUMPLE_HD_COLD inline int contact_at_start(const FourPoints& points) {
    const Vec3d a = points[0].start, b = points[1].start, c = points[2].start, d = points[3].start;
    if (!in_expansion_range(a) || !in_expansion_range(b) || !in_expansion_range(c) || !in_expansion_range(d)) return 0;
    if (orient3d(a, b, c, d) != 0) return -1;
    const int axis = detail::axis_of_plane(a, b, c, d);
    if (axis < 0) return 0;
    if constexpr (pair == FeaturePair::vertex_face) {
        const int turn = orient2d(b, c, d, axis);
        if (turn == 0) return 0;
        const auto inside = [&](const Vec3d& from, const Vec3d& to) { return orient2d(from, to, a, axis) * turn >= 0; };
        return inside(b, c) && inside(c, d) && inside(d, b) ? 1 : -1;
    } else {
        const bool meet = orient2d(a, b, c, axis) * orient2d(a, b, d, axis) <= 0 &&
                          orient2d(c, d, a, axis) * orient2d(c, d, b, axis) <= 0;
        return meet ? 1 : -1;
    }
}

}  // namespace crumple
