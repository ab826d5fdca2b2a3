#pragma once

// Frame in which a leaf is swept, and the box that the stage `align` computes in it for any primitive (docs/align.md).
// A leaf is a small set of primitives, its members, that one sweep searches. A primitive is the hull of a few corners;
// the rest of its record depends on the kind of query. Compiled for host and device.
//
// Corners are taken relative to the leaf's origin and rounded to float32; a computed coordinate of a box is off by less
// than box_margin(reach), where `reach` is the largest |coordinate| of the leaf's corners. Members far larger than
// their leaf ("big"), for example two ground triangles under fine cloth, would spoil the leaf's quantisation range and
// error bound for all members. So they count in neither, and their boxes have margins of their own (measured in
// docs/unequal_sizes.md).

#include "geometry/vec.h"

namespace crumple {

inline constexpr float unit_roundoff = 0x1p-24f;  ///< u, the largest relative rounding error of float32

/// Frame in which a leaf is swept: the sweep direction is the first axis.
struct LeafFrame {
    Vec3f origin;
    Vec3f axis[3];
    float big = 0;  ///< a member is big if one of its coordinates, relative to the origin, exceeds this in magnitude
};

/// Returns the margin by which a box is widened on each side; `reach`: the largest |coordinate| of the leaf's corners.
CRUMPLE_HD inline float box_margin(float reach) { return 12 * unit_roundoff * reach + 1e-30f; }

/// A big member counts in its leaf's `reach` with this share of its own largest |coordinate|, so that the leaf's error
/// bound, in float32 roundings, covers errors of the member in float64.
inline constexpr float big_share = 0x1p-28f;

CRUMPLE_HD inline Vec3f to_float(const Vec3d& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// Widens the box of a big member; `reach`: the largest |coordinate| of its corners.
template <class Corner>
CRUMPLE_HD void widen_big(float reach, Corner& low, Corner& high) {
    // A box's error grows with its coordinates. A margin of 9 u times `reach` would suffice, see docs/align.md.
    const float margin = 16 * unit_roundoff * reach;
    low.x -= margin, low.y -= margin, low.z -= margin;
    high.x += margin, high.y += margin, high.z += margin;
}

/// Primitive with `corners` corners in a leaf's frame.
template <int corners>
struct InFrame {
    Vec3d relative[corners];  ///< corners minus the origin, along the scene's axes
    Vec3f corner[corners];    ///< `relative`, rounded to float32
    Vec3f low, high;          ///< box, along the frame's axes
    float reach;              ///< largest |coordinate| of a corner
    bool big;

    /// Computes all fields from the normalised corners `p`.
    CRUMPLE_HD InFrame(const Vec3d p[corners], const LeafFrame& frame) : reach(0) {
        const Vec3d origin{frame.origin.x, frame.origin.y, frame.origin.z};
        for (int k = 0; k < corners; ++k) {
            relative[k] = p[k] - origin;
            const Vec3f q = corner[k] = to_float(relative[k]);
            const Vec3f turned{dot(frame.axis[0], q), dot(frame.axis[1], q), dot(frame.axis[2], q)};
            low = k == 0 ? turned : min(low, turned);
            high = k == 0 ? turned : max(high, turned);
            reach = max(reach, largest(abs(q)));
        }
        big = reach > frame.big;
        if (big) widen_big(reach, low, high);
    }

    /// Returns the extent with which this member counts in the leaf's `reach`, the largest of its members' values.
    CRUMPLE_HD float counted_extent() const { return big ? big_share * reach : reach; }
};

}  // namespace crumple
