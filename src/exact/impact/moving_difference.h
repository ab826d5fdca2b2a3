#pragma once

// Two moving features as the differences between their points: w + s u + t v, where w, u and v are linear in time and
// (s, t) is in a domain, the convex hull of some corners. The distance of the features is the length of the shortest
// difference. Compiled for host and device.
//
//     vertex p, face a b c     w = a - p, u = b - a, v = c - a     s, t >= 0, s + t <= 1
//     edges a b, c d           w = a - c, u = b - a, v = c - d     s, t in [0, 1]
//     vertex p, edge a b       w = a - p, u = b - a                s in [0, 1]
//     vertices p, q            w = p - q                           s = t = 0

#include <array>

#include "exact/impact/impact.h"
#include "exact/proximity/static_features.h"

namespace crumple::detail {

template <class T>
struct Difference {
    Vec3<T> w{}, u{}, v{};
};

/// Returns the difference for points p, q, r, s; subtract(x, y) returns x - y.
template <FeatureKinds kinds, class Point, class Subtract>
CRUMPLE_HD inline auto difference(const Point& p, const Point& q, const Point& r, const Point& s, Subtract subtract) {
    Difference<decltype(subtract(p, p).x)> x;
    if constexpr (kinds == FeatureKinds::vertex_face) {
        x = {subtract(q, p), subtract(r, q), subtract(s, q)};
    } else if constexpr (kinds == FeatureKinds::edge_edge) {
        x = {subtract(p, r), subtract(q, p), subtract(r, s)};
    } else if constexpr (kinds == FeatureKinds::vertex_edge) {
        x.w = subtract(q, p), x.u = subtract(r, q);
    } else {
        x.w = subtract(p, q);
    }
    return x;
}

/// Number of corners of the domain, the first ones of (0, 0), (1, 0), (0, 1), (1, 1).
template <FeatureKinds kinds>
inline constexpr std::size_t corners = kinds == FeatureKinds::edge_edge     ? 4
                                       : kinds == FeatureKinds::vertex_face ? 3
                                       : kinds == FeatureKinds::vertex_edge ? 2
                                                                            : 1;

/// Point of the domain: (s, t) if `inside`; otherwise (s + r ds, t + r dt), which is on a side of the domain that
/// starts at corner (s, t).
struct DomainPoint {
    double s = 0, t = 0, ds = 0, dt = 0, r = 0;
    bool inside = false;
};

/// Returns approximately the point of the domain at which the difference is shortest. Rounding errors may put it
/// slightly outside of the domain, but never far.
template <FeatureKinds kinds>
CRUMPLE_HD inline DomainPoint closest(const Difference<double>& x) {
    const Vec3d &w = x.w, &u = x.u, &v = x.v;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
    if constexpr (corners < kinds >> 2) {
        const double area = uu * vv - uv * uv, s = (uv * vw - vv * uw) / area, t = (uv * uw - uu * vw) / area;
        const bool below = kinds == FeatureKinds::edge_edge ? s < 1 && t < 1 : s + t < 1;
        if (area > 0x1p-44 * (uu * vv) && s > 0 && t > 0 && below) return {s, t, 0, 0, 0, true};
    }
    DomainPoint best;
    double least = dot(w, w);
    const auto side = [&](double s, double t, double ds, double dt) {
        const Vec3d from = w + (s * u + t * v), along = ds * u + dt * v;
        const double length = dot(along, along), place = -dot(from, along);
        const double r = place > 0 ? (place < length ? place / length : 1) : 0;
        const Vec3d g = from + r * along;
        const double squared = dot(g, g);
        if (squared < least) least = squared, best = {s, t, ds, dt, r, false};
    };
    if constexpr (corners < kinds >> 1) side(0, 0, 1, 0);
    if constexpr (corners < kinds >> 2) side(0, 0, 0, 1);
    if constexpr (corners<kinds> == 3) side(1, 0, -1, 1);
    if constexpr (corners<kinds> == 4) side(1, 0, 0, 1), side(0, 1, 1, 0);
    return best;
}

CRUMPLE_HD inline Vec3d at(const Difference<double>& x, const DomainPoint& p) {
    return x.w + ((p.s + p.r * p.ds) * x.u + (p.t + p.r * p.dt) * x.v);
}

}  // namespace crumple::detail
