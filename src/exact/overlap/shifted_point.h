#pragma once

// Points at which edges cross faces, as functions of the infinitesimal shift (e, e², e³) of the second surface. Host
// only.

#include "exact/overlap/shifted_number.h"

namespace crumple {

/// Edge of surface `side` (0 or 1) that crosses a face of the other surface.
struct CrossedEdge {
    std::size_t side = 0;
    Vec3d from, to;
    FaceCorners face;
};

using ShiftedPoint = Vec3<ShiftedNumber>;

/// Returns the parameter at which an edge crosses a face: 0 at `from`, 1 at `to`.
inline ShiftedNumber shifted_parameter(const CrossedEdge& edge) {
    const auto rational = [](const Vec3d& p) { return Vec3<Rational>{Rational(p.x), Rational(p.y), Rational(p.z)}; };
    const Vec3<Rational> from = rational(edge.from), q = rational(edge.face[0]);
    const Vec3<Rational> normal = cross(rational(edge.face[1]) - q, rational(edge.face[2]) - q);
    const Rational all = dot(normal, from - rational(edge.to));
    ShiftedNumber t{Rational(dot(normal, from - q) / all)};
    for (int axis = 0; axis < 3; ++axis) {
        const Rational change = normal[axis] / all;
        t = t + ShiftedNumber::power(static_cast<std::size_t>(axis) + 1, edge.side == 0 ? Rational(-change) : change);
    }
    return t;
}

/// Returns a vertex of surface `side`.
inline ShiftedPoint shifted_vertex(const Vec3d& p, std::size_t side) {
    ShiftedPoint point;
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = ShiftedNumber(p[axis]);
        if (side == 1) point[axis] = point[axis] + ShiftedNumber::power(static_cast<std::size_t>(axis) + 1, 1);
    }
    return point;
}

inline ShiftedPoint shifted_point(const CrossedEdge& edge) {
    const ShiftedNumber t = shifted_parameter(edge);
    ShiftedPoint point = shifted_vertex(edge.from, edge.side);
    for (int axis = 0; axis < 3; ++axis)
        point[axis] = point[axis] + t * ShiftedNumber(Rational(edge.to[axis]) - Rational(edge.from[axis]));
    return point;
}

}  // namespace crumple
