#pragma once

// What `align` makes of one member of a leaf: a record for the filters of `narrow`, and a box in the leaf's frame
// (docs/align.md, docs/narrow.md). Compiled for host and device.
//
// A Record is one cache line, transposed so that a load of four floats is one coordinate of three corners and of the
// normal:
//
//     x0 x1 x2 nx | y0 y1 y2 ny | z0 z1 z2 nz | id0 id1 id2 c
//
// Corners are relative to the leaf's origin. The plane n . p = c is scaled by its error bound, so that a corner p of
// any member lies for certain on the side of sign(n . p - c) iff |n . p - c| > 1. Members far larger than their leaf
// ("big"), two ground triangles under fine cloth, say, would ruin the leaf's range of quantisation and its error bound
// for everybody. So their boxes are clamped to the leaf and their corners are NaN, which no filter decides anything
// from, as comparisons with NaN keep a pair; only their plane, computed in float64, still separates small members from
// them ([MZ] 5.1; measured in docs/unequal_sizes.md).

#include <cstdint>
#include <limits>

#include "geometry/vec.h"

namespace crumple {

/// Planes are scaled by 1 / (plane_bound u reach): the error of n . p - c (docs/narrow.md).
inline constexpr float plane_bound = 28;
inline constexpr float unit_roundoff = 0x1p-24f;  ///< u

/// What covers underflow, and subnormal numbers that are taken for zero, in the filters (docs/narrow.md): in the sum
/// that a plane is divided by, in a determinant, in a turn; in float64, where rows are of float32 or of float64.
inline constexpr float plane_slack = 1e-28f, determinant_slack = 1e-34f, turn_slack = 1e-35f;
inline constexpr double float32_rows_slack = 1e-35, float64_rows_slack = 1e-290;

struct alignas(64) Record {
    float x[4], y[4], z[4];
    std::int32_t id[3];
    float c;
};
static_assert(sizeof(Record) == 64);

/// The frame in which a leaf is swept: sweep direction first.
struct LeafFrame {
    Vec3f origin;
    Vec3f axis[3];
    float big = 0;  ///< members that reach further than this from the origin, in any coordinate, are big
};

/// What planes of a leaf are multiplied with; `reach` is the largest |coordinate| of its corners.
CRUMPLE_HD inline float plane_scale(float reach) { return 1.0f / (plane_bound * unit_roundoff * reach + 1e-30f); }

CRUMPLE_HD inline Vec3f to_float(const Vec3d& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// The normal a × b, over the sum of its products' magnitudes, in which the error bound is expressed.
template <class T>
CRUMPLE_HD Vec3<T> plane_normal(const Vec3<T>& a, const Vec3<T>& b) {
    const T sum = (std::abs(a.y * b.z) + std::abs(a.z * b.y)) + (std::abs(a.z * b.x) + std::abs(a.x * b.z)) +
                  (std::abs(a.x * b.y) + std::abs(a.y * b.x)) + static_cast<T>(plane_slack);
    const Vec3<T> n = cross(a, b);
    return {n.x / sum, n.y / sum, n.z / sum};
}

/// Rewrites the record and widens the box of a member that reaches `reach` > frame.big from the origin.
/// `p`: its corners relative to the leaf's origin; a, b: its edges from the first one.
template <class BoxCorner>
CRUMPLE_HD void make_big(const Vec3d p[3], const Vec3d& a, const Vec3d& b, float reach, Record& record, BoxCorner& low,
                         BoxCorner& high) {
    // A box's error grows with its own coordinates: 8 u each side would do, see docs/align.md.
    const float margin = 16 * unit_roundoff * reach;
    low.x -= margin, low.y -= margin, low.z -= margin;
    high.x += margin, high.y += margin, high.z += margin;
    const Vec3d n = plane_normal(a, b);
    for (int k = 0; k < 3; ++k) record.x[k] = record.y[k] = record.z[k] = std::numeric_limits<float>::quiet_NaN();
    record.x[3] = static_cast<float>(n.x);
    record.y[3] = static_cast<float>(n.y);
    record.z[3] = static_cast<float>(n.z);
    record.c = static_cast<float>(dot(n, p[0]));
}

/// A member's record, its plane not yet scaled, and its box. Big ones do not count in the leaf's own box.
struct Member {
    Record record;
    Vec3f low, high;  ///< in the leaf's frame
    float reach;      ///< the leaf's is at least this: the largest |coordinate| of a corner, of big ones 2^-28 of that
    bool big;
};

/// `p`: the normalised corners.
CRUMPLE_HD inline Member member_of(const Vec3d p[3], const std::int32_t id[3], const LeafFrame& frame) {
    Member m;
    const Vec3d origin{frame.origin.x, frame.origin.y, frame.origin.z};
    const Vec3d relative[3] = {p[0] - origin, p[1] - origin, p[2] - origin};
    Vec3f q[3], turned[3];
    for (int k = 0; k < 3; ++k) {
        q[k] = to_float(relative[k]);
        turned[k] = {dot(frame.axis[0], q[k]), dot(frame.axis[1], q[k]), dot(frame.axis[2], q[k])};
    }
    m.low = min(turned[0], min(turned[1], turned[2]));
    m.high = max(turned[0], max(turned[1], turned[2]));
    m.reach = max(largest(abs(q[0])), max(largest(abs(q[1])), largest(abs(q[2]))));
    m.big = m.reach > frame.big;
    const Vec3f n = plane_normal(to_float(p[1] - p[0]), to_float(p[2] - p[0]));
    m.record = {{q[0].x, q[1].x, q[2].x, n.x},
                {q[0].y, q[1].y, q[2].y, n.y},
                {q[0].z, q[1].z, q[2].z, n.z},
                {id[0], id[1], id[2]},
                dot(n, q[0])};
    if (m.big) {
        make_big(relative, p[1] - p[0], p[2] - p[0], m.reach, m.record, m.low, m.high);
        m.reach *= 0x1p-28f;
    }
    return m;
}

CRUMPLE_HD inline void scale_plane(Record& record, float scale) {
    record.x[3] *= scale;
    record.y[3] *= scale;
    record.z[3] *= scale;
    record.c *= scale;
}

}  // namespace crumple
