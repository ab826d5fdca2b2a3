#pragma once

// Edge lines (lines through an edge, in a projection along an axis) and planes that certainly separate two triangles,
// except for their shared corners: the flat test and the separating tests of `narrow` for one pair. Claims and bounds:
// docs/narrow.md; SIMD counterparts: backends/cpu/intersections/flat_test-inl.h and separating_plane-inl.h. Compiled
// for host and device.

#include "filters/intersection/triangle_record.h"
#include "geometry/point_rows.h"

namespace crumple {

/// Projected triangle, with the bits of its shared corners.
template <class T>
struct FlatTriangle {
    T u[3], w[3];
    unsigned shared;
};

/// Errors that turn_sign() allows for. `delta`: error of a difference of coordinates in addition to its own rounding;
/// `tiny`: slack that covers underflow.
template <class T>
struct FlatError {
    T delta, tiny;
};

/// Returns the sign of the turn from a to b, two vectors in a projection, if it is certain, else 0.
template <class T>
CRUMPLE_HD int turn_sign(T au, T aw, T bu, T bw, const FlatError<T>& e) {
    const T m = au * bw, n = aw * bu, value = m - n;
    const T size = (std::abs(au) + std::abs(aw)) + (std::abs(bu) + std::abs(bw));
    const T error = turn_error<T> * (std::abs(m) + std::abs(n)) + (e.delta * size + (2 * e.delta * e.delta + e.tiny));
    return value > error ? 1 : value < -error ? -1 : 0;
}

/// Returns true if an edge line of t has t's third corner, which must not be shared, strictly on one side, and the
/// corners of `other` that are not shared strictly on the other side.
template <class T>
CRUMPLE_HD bool edge_line_separates(const FlatTriangle<T>& t, const FlatTriangle<T>& other, const FlatError<T>& e) {
    for (int k = 0; k < 3; ++k) {
        const int end = k == 2 ? 0 : k + 1, apex = 3 - k - end;
        if (t.shared >> apex & 1) continue;
        const T eu = t.u[end] - t.u[k], ew = t.w[end] - t.w[k];
        const int own = turn_sign(eu, ew, t.u[apex] - t.u[k], t.w[apex] - t.w[k], e);
        bool separates = own != 0;
        for (int j = 0; j < 3 && separates; ++j) {
            separates =
                (other.shared >> j & 1) || turn_sign(eu, ew, other.u[j] - t.u[k], other.w[j] - t.w[k], e) == -own;
        }
        if (separates) return true;
    }
    return false;
}

/// Returns true if an edge line of either triangle separates them in the projection along the largest component of a's
/// normal.
template <class T>
CRUMPLE_HD bool edge_lines_separate(const Vec3<T> a[3], unsigned shared_a, const Vec3<T> b[3], unsigned shared_b,
                                    const Vec3<T>& normal, const FlatError<T>& e) {
    const Vec3<T> n = abs(normal);
    const int axis = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    FlatTriangle<T> flat_a{{}, {}, shared_a}, flat_b{{}, {}, shared_b};
    for (int k = 0; k < 3; ++k) {
        const int u = axis == 2 ? 0 : axis + 1, w = axis == 0 ? 2 : axis - 1;
        flat_a.u[k] = a[k][u], flat_a.w[k] = a[k][w];
        flat_b.u[k] = b[k][u], flat_b.w[k] = b[k][w];
    }
    return edge_line_separates(flat_a, flat_b, e) || edge_line_separates(flat_b, flat_a, e);
}

/// Returns true if an edge line separates a pair in float32. Reads corners from `points` if these are float32 and so
/// exact; otherwise from the records, whose corners were rounded when the origin of their leaf (triangle_record.h) was
/// subtracted. `reach`: the largest |coordinate| of the leaf's corners. At least one corner of each triangle must not
/// be shared.
CRUMPLE_HD inline bool separated_in_float(const Record& a, const Record& b, unsigned shared_a, unsigned shared_b,
                                          const PointRows& points, float reach) {
    const auto corner = [&](const Record& r, int k) {
        if (!points.f) return Vec3f{r.x[k], r.y[k], r.z[k]};
        return points.in_float(r.id[k]);
    };
    const Vec3f p[3] = {corner(a, 0), corner(a, 1), corner(a, 2)}, q[3] = {corner(b, 0), corner(b, 1), corner(b, 2)};
    const FlatError<float> error{points.f ? 0.0f : corner_error(reach), turn_slack};
    return edge_lines_separate(p, shared_a, q, shared_b, {a.x[3], a.y[3], a.z[3]}, error);
}

/// Returns true if the corners of `other` that are not shared lie strictly on one side of the plane of t. Writes its
/// normal.
CRUMPLE_HD inline bool plane_separates(const Vec3d t[3], const Vec3d other[3], unsigned shared, double tiny, Vec3d& n) {
    const Vec3d a = t[1] - t[0], b = t[2] - t[0];
    const Vec3d plus{a.y * b.z, a.z * b.x, a.x * b.y}, minus{a.z * b.y, a.x * b.z, a.y * b.x};
    const Vec3d size = abs(plus) + abs(minus);
    n = plus - minus;
    bool above = true, below = true;
    for (int k = 0; k < 3; ++k) {
        if (shared >> k & 1) continue;
        const Vec3d w = other[k] - t[0];
        const double value = dot(n, w), error = plane_error * dot(size, abs(w)) + tiny;
        above = above && value > error;
        below = below && value < -error;
    }
    return above || below;
}

/// Returns true if a plane or an edge line separates a pair in float64, computed from the normalised vertices.
CRUMPLE_HD inline bool separated_in_double(const Record& a, const Record& b, unsigned shared_a, unsigned shared_b,
                                           const PointRows& points) {
    const double tiny = points.f ? float32_rows_slack : float64_rows_slack;
    const Vec3d p[3] = {points[a.id[0]], points[a.id[1]], points[a.id[2]]};
    const Vec3d q[3] = {points[b.id[0]], points[b.id[1]], points[b.id[2]]};
    Vec3d normal, unused;
    return plane_separates(p, q, shared_b, tiny, normal) || plane_separates(q, p, shared_a, tiny, unused) ||
           edge_lines_separate<double>(p, shared_a, q, shared_b, normal, {0.0, tiny});
}

}  // namespace crumple
