#pragma once

// Rotation of a frame about its first axis so that edges lie along its other axes. This makes the boxes of long
// triangles slim, because the edges of a designed part have few directions (docs/align.md). Compiled for host and
// device.

#include <cmath>

#include "geometry/eigen.h"

namespace crumple {

/// Sum of l^2 exp(4 i phi) over edges, as a complex number. l is the length of an edge's projection onto the plane of
/// the second and the third axis, and phi the angle of that projection from the second axis.
struct EdgeMoment {
    double re = 0, im = 0;

    CRUMPLE_HD void add_edge(const Vec3d& edge, const PrincipalAxes& axes) {
        const double y = dot(edge, axes.axis[1]), z = dot(edge, axes.axis[2]);
        const double l2 = y * y + z * z, cosine = y * y - z * z, sine = 2 * y * z;  // l^2 cos(2 phi), l^2 sin(2 phi)
        if (!(l2 > 0)) return;
        re += (cosine * cosine - sine * sine) / l2;
        im += 2 * cosine * sine / l2;
    }
    CRUMPLE_HD void add_triangle(const Vec3d& p, const Vec3d& q, const Vec3d& r, const PrincipalAxes& axes) {
        add_edge(q - p, axes);
        add_edge(r - q, axes);
        add_edge(p - r, axes);
    }
};

/// Rotates the second and third axis by a quarter of the angle of `moment`, a complex number: by at most 45 degrees.
CRUMPLE_HD inline void turn_to_edges(PrincipalAxes& axes, const EdgeMoment& moment) {
    const double angle = std::atan2(moment.im, moment.re) / 4, c = std::cos(angle), s = std::sin(angle);
    const Vec3d y = axes.axis[1], z = axes.axis[2];
    axes.axis[1] = c * y + s * z;
    axes.axis[2] = c * z - s * y;
}

}  // namespace crumple
