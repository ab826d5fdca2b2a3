#pragma once

// Record of a triangle in a leaf (set of triangles that one sweep searches) for queries about features: corners at one
// time sample, or at the start and at the end of a step (x0' and so on), and the ids of its features. Compiled for host
// and device.
//
// Corners are relative to the leaf's origin, in rows of four, so that one load yields a coordinate of three corners and
// of the normal:
//
//     x0 x1 x2 nx [x0' x1' x2' nx'] | y ... | z ... | vertices, owned | edges, triangle
//
// Normals have length 1 up to rounding; a triangle without a normal has 0. Corners and normals of big members
// (leaf_frame.h) are NaN, from which no filter concludes anything.

#include <cstdint>
#include <limits>

#include "geometry/leaf_frame.h"

namespace crumple {

template <int moments>
struct alignas(16) FeatureRecord {
    float x[4 * moments], y[4 * moments], z[4 * moments];
    std::int32_t vertex[3];
    std::uint32_t owned;   ///< bits of the corners and edges that the triangle owns (SceneFeatures::owned)
    std::int32_t edge[3];  ///< index of the edge on each side; for -1 see TriangleEdges
    std::int32_t triangle;

    CRUMPLE_HD Vec3f at(int i) const { return {x[i], y[i], z[i]}; }
    /// Returns corner k at a time sample. Chooses it by comparisons, because a device keeps a record in registers,
    /// which it cannot index by a computed number.
    CRUMPLE_HD Vec3f corner(int moment, int k) const {
        const int i = 4 * moment;
        return k == 0 ? at(i) : k == 1 ? at(i + 1) : at(i + 2);
    }
    CRUMPLE_HD void set(int i, const Vec3f& p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
};

/// Returns v divided by its length, or 0 if v is too short. The length errs by a few units in the last place.
CRUMPLE_HD inline Vec3f direction(const Vec3f& v) {
    const float size = largest(abs(v));
    if (!(size > 1e-30f)) return {0, 0, 0};
    const Vec3f w = (1 / size) * v;  // no overflow, and no underflow that matters
    return (1 / std::sqrt(dot(w, w))) * w;
}

/// Writes corners and normals. `p`: the normalised corners at the start, then those at the end.
template <int moments>
CRUMPLE_HD void write_geometry(const Vec3d p[3 * moments], const InFrame<3 * moments>& member,
                               FeatureRecord<moments>& record) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    for (int m = 0; m < moments; ++m) {
        const Vec3d* corner = p + 3 * m;
        const Vec3f normal = direction(cross(to_float(corner[1] - corner[0]), to_float(corner[2] - corner[0])));
        for (int k = 0; k < 4; ++k) {
            const Vec3f q = k < 3 ? member.corner[3 * m + k] : normal;
            record.set(4 * m + k, member.big ? Vec3f{nan, nan, nan} : q);
        }
    }
}

}  // namespace crumple
