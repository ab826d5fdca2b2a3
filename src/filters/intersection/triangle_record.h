#pragma once

// Record of a triangle in a leaf (set of triangles that one sweep searches), for the intersection filters of `narrow`
// (docs/narrow.md). Compiled for host and device.
//
// A Record is one cache line, transposed so that a load of four floats is one coordinate of three corners and of the
// normal:
//
//     x0 x1 x2 nx | y0 y1 y2 ny | z0 z1 z2 nz | id0 id1 id2 c
//
// Corners are relative to the leaf's origin. The plane n . p = c is scaled by its error bound, so that a corner p of
// any member certainly lies on the side of sign(n . p - c) iff |n . p - c| > 1. Corners of big members (leaf_frame.h)
// are NaN. Comparisons with NaN are false, so no filter decides by such corners; only the planes of big members,
// computed in float64, still separate small members from them.

#include <cstdint>
#include <limits>

#include "geometry/leaf_frame.h"

namespace crumple {

/// Planes are scaled by 1 / (plane_bound u reach), the inverse of the error of n . p - c (docs/narrow.md).
inline constexpr float plane_bound = 28;

/// Slacks of the filters that cover underflow and subnormal numbers taken as zero (docs/narrow.md): for the sum that
/// plane_normal() divides by, for a determinant, and for a turn; in float64, for normalised vertices stored as float32
/// or as float64.
inline constexpr float plane_slack = 1e-28f, determinant_slack = 1e-34f, turn_slack = 1e-35f;
inline constexpr double float32_rows_slack = 1e-35, float64_rows_slack = 1e-290;

/// Errors of the filters' values, relative to the sum of their monomials' magnitudes (docs/narrow.md): of a determinant
/// of relative corners, of a turn in projection and, in float64, of the value n . p - c of a plane at a point.
inline constexpr float determinant_error = 10 * unit_roundoff;
template <class T>
inline constexpr T turn_error = static_cast<T>(6 * (sizeof(T) == 4 ? 0x1p-24 : 0x1p-53));
inline constexpr double plane_error = 10 * 0x1p-53;

/// Returns how far a coordinate of a difference of two relative corners errs in addition to its own rounding, because
/// each corner was rounded when the leaf's origin was subtracted. `reach`: the leaf's largest |coordinate|.
CRUMPLE_HD constexpr float corner_error(float reach) { return 2.1f * unit_roundoff * reach; }

struct alignas(64) Record {
    float x[4], y[4], z[4];
    std::int32_t id[3];
    float c;
};
static_assert(sizeof(Record) == 64);

/// Returns the factor that scales the planes of a leaf; `reach`: the largest |coordinate| of its corners.
CRUMPLE_HD inline float plane_scale(float reach) { return 1.0f / (plane_bound * unit_roundoff * reach + 1e-30f); }

/// Returns the normal a × b divided by the sum of its products' magnitudes: the error bound is relative to this sum.
template <class T>
CRUMPLE_HD Vec3<T> plane_normal(const Vec3<T>& a, const Vec3<T>& b) {
    const T sum = (std::abs(a.y * b.z) + std::abs(a.z * b.y)) + (std::abs(a.z * b.x) + std::abs(a.x * b.z)) +
                  (std::abs(a.x * b.y) + std::abs(a.y * b.x)) + static_cast<T>(plane_slack);
    const Vec3<T> n = cross(a, b);
    return {n.x / sum, n.y / sum, n.z / sum};
}

/// Rewrites the geometry in the record of a big member. `p`: its corners relative to the leaf's origin; a, b: its edges
/// from the first corner.
CRUMPLE_HD inline void make_big(const Vec3d p[3], const Vec3d& a, const Vec3d& b, Record& record) {
    const Vec3d n = plane_normal(a, b);
    for (int k = 0; k < 3; ++k) record.x[k] = record.y[k] = record.z[k] = std::numeric_limits<float>::quiet_NaN();
    record.x[3] = static_cast<float>(n.x);
    record.y[3] = static_cast<float>(n.y);
    record.z[3] = static_cast<float>(n.z);
    record.c = static_cast<float>(dot(n, p[0]));
}

/// Returns a triangle's record, with its plane not yet scaled. `p`: the normalised corners.
CRUMPLE_HD inline Record record_of(const Vec3d p[3], const std::int32_t id[3], const InFrame<3>& member) {
    const Vec3f* const q = member.corner;
    const Vec3f n = plane_normal(to_float(p[1] - p[0]), to_float(p[2] - p[0]));
    Record record{{q[0].x, q[1].x, q[2].x, n.x},
                  {q[0].y, q[1].y, q[2].y, n.y},
                  {q[0].z, q[1].z, q[2].z, n.z},
                  {id[0], id[1], id[2]},
                  dot(n, q[0])};
    if (member.big) make_big(member.relative, p[1] - p[0], p[2] - p[0], record);
    return record;
}

CRUMPLE_HD inline void scale_plane(Record& record, float scale) {
    record.x[3] *= scale;
    record.y[3] *= scale;
    record.z[3] *= scale;
    record.c *= scale;
}

}  // namespace crumple
