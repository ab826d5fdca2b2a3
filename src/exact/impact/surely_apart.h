#pragma once

// Cheap proofs that two moving features never touch: a fixed direction that separates them at the start and at the end,
// hence always, because projections are linear in time; or Bernstein coefficients of the volume that all have one sign.
// In float64 with proven bounds (docs/motion_filters.md), about 60 ns; accepts any coordinates. Compiled for host and
// device.

#include "exact/impact/volume.h"

namespace crumple {
namespace detail {

/// Returns the side, 1 or −1, on which the other feature certainly lies beyond the first one along a line, or 0 if
/// neither is certain. `u`, `v`, `w`: projections of the vectors (approach.h) onto the line. The first feature is the
/// face 0, u, v or the edge from 0 to u.
template <FeaturePair pair>
CRUMPLE_HD inline int side(double u, double v, double w, double bound) {
    if constexpr (pair == FeaturePair::vertex_face)  // vertex w and face 0, u, v
        return w > max(max(u, v), 0.) + bound ? 1 : w < min(min(u, v), 0.) - bound ? -1 : 0;
    // The edges from w to w + v and from 0 to u.
    return min(w, w + v) > max(u, 0.) + bound ? 1 : max(w, w + v) < min(u, 0.) - bound ? -1 : 0;
}

/// True if a direction certainly separates the features at all times. Any direction is valid.
template <FeaturePair pair>
CRUMPLE_HD inline bool separates(const Vec3d& direction, const Approach<pair>& x) {
    const double bound = 8 * epsilon * dot(abs(direction), x.extent_u + x.extent_v + x.extent_w) + x.slack;
    const int start =
        side<pair>(dot(direction, x.u.start), dot(direction, x.v.start), dot(direction, x.w.start), bound);
    return start != 0 &&
           start == side<pair>(dot(direction, x.u.end), dot(direction, x.v.end), dot(direction, x.w.end), bound);
}

/// Returns the vector from the middle of the face to the vertex, or from the middle of the first edge to that of the
/// second.
template <FeaturePair pair>
CRUMPLE_HD inline Vec3d between_middles(const Vec3d& u, const Vec3d& v, const Vec3d& w) {
    if constexpr (pair == FeaturePair::vertex_face) return w - 1. / 3 * (u + v);
    return w + 0.5 * (v - u);
}
template <FeaturePair pair>
CRUMPLE_HD inline Vec3d start_between_middles(const Approach<pair>& x) {
    return between_middles<pair>(x.u.start, x.v.start, x.w.start);
}
template <FeaturePair pair>
CRUMPLE_HD inline Vec3d end_between_middles(const Approach<pair>& x) {
    return between_middles<pair>(x.u.end, x.v.end, x.w.end);
}

/// True if a direction perpendicular to an edge separates the features: the vector between their middles at one end of
/// the motion, without its component along the edge. Meant for features of which the volume decides nothing; most of
/// these stay in one plane.
template <FeaturePair pair>
CRUMPLE_HD inline bool separated_beside_an_edge(const Approach<pair>& x) {
    const auto beside = [&](const Vec3d& way, const Vec3d& edge) {
        return separates(dot(edge, edge) * way - dot(way, edge) * edge, x);
    };
    const auto any = [&](const Vec3d& way, const Vec3d& u, const Vec3d& v) {
        return beside(way, u) || beside(way, v) || (pair == FeaturePair::vertex_face && beside(way, v - u));
    };
    return any(start_between_middles(x), x.u.start, x.v.start) || any(end_between_middles(x), x.u.end, x.v.end);
}

}  // namespace detail

/// True if the features certainly never touch. Requires x.in_range(); `volume` must be that of x.
template <FeaturePair pair>
CRUMPLE_HD inline bool surely_apart(const Approach<pair>& x, const Volume& volume) {
    const Vec3d start = detail::start_between_middles(x), end = detail::end_between_middles(x);
    return detail::separates(start + end, x) || volume.never_zero() ||
           detail::separates(cross(x.u.start, x.v.start), x) || detail::separates(cross(x.u.end, x.v.end), x) ||
           detail::separates(start, x) || detail::separates(end, x);
}

template <FeaturePair pair>
CRUMPLE_HD inline bool surely_apart(const FourPoints& points) {
    const Approach<pair> x(points);
    return x.in_range() && surely_apart(x, Volume(x));
}

}  // namespace crumple
