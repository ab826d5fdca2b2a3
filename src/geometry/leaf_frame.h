#pragma once

// The frame in which a leaf is swept, and what `align` makes of any primitive there: its box (docs/align.md). A
// primitive is the hull of a few corners; what else a record keeps of it depends on the kind of query. Compiled
// for host and device.
//
// Corners are taken relative to the leaf's origin and rounded to float32; a computed coordinate of a box errs by less
// than box_margin(reach). Members far larger than their leaf ("big"), two ground triangles under fine cloth, say, would
// ruin the leaf's range of quantisation and its error bound for everybody. So they do not count in either, and their
// boxes carry a margin of their own ([MZ] 5.1; measured in docs/unequal_sizes.md).

#include "geometry/vec.h"

namespace crumple {

inline constexpr float unit_roundoff = 0x1p-24f;  ///< u

/// The frame in which a leaf is swept: sweep direction first.
struct LeafFrame {
    Vec3f origin;
    Vec3f axis[3];
    float big = 0;  ///< members that reach further than this from the origin, in any coordinate, are big
};

/// What a box's start is moved down by and its end up; `reach`: the largest |coordinate| of the leaf's corners.
CRUMPLE_HD inline float box_margin(float reach) { return 12 * unit_roundoff * reach + 1e-30f; }

/// Big members count in their leaf's reach by this share, so that what float64 makes of them stays within its errors.
inline constexpr float big_share = 0x1p-28f;

CRUMPLE_HD inline Vec3f to_float(const Vec3d& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// Widens the box of a member that reaches `reach` > LeafFrame::big from the origin.
template <class Corner>
CRUMPLE_HD void widen_big(float reach, Corner& low, Corner& high) {
    // A box's error grows with its own coordinates: 8 u each side would do, see docs/align.md.
    const float margin = 16 * unit_roundoff * reach;
    low.x -= margin, low.y -= margin, low.z -= margin;
    high.x += margin, high.y += margin, high.z += margin;
}

/// A primitive of so many corners in a leaf's frame.
template <int corners>
struct InFrame {
    Vec3d relative[corners];  ///< to the origin, along the scene's axes
    Vec3f corner[corners];    ///< the same, rounded
    Vec3f low, high;          ///< the box, along the frame's axes
    float reach;              ///< largest |coordinate| of a corner
    bool big;

    /// `p`: the normalised corners.
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

    /// What the leaf's reach is at least.
    CRUMPLE_HD float counted_reach() const { return big ? big_share * reach : reach; }
};

}  // namespace crumple
