#pragma once

// Exact test of a candidate: two boxes, each inflated by r, overlap in real numbers. That means low - r <= high + r on
// each axis, where low is of either box and high of the other. Rounding is monotone, so unequal rounded sums decide. If
// they are equal, their rounding errors decide, which are float64 numbers. Compiled for host and device.

#include <cmath>

#include "geometry/expansion.h"
#include "geometry/vec.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Box of some points, not inflated.
struct FeatureBox {
    Vec3d low, high;

    CRUMPLE_HD explicit FeatureBox(const Vec3d& p) : low(p), high(p) {}
    CRUMPLE_HD void add(const Vec3d& p) { low = min(low, p), high = max(high, p); }
};

/// Returns the box of `count` vertices or, if the scene moves, of their trajectories. Exact: reads the caller's
/// coordinates.
inline FeatureBox swept_box(const PreparedScene& scene, const std::int32_t* vertex, int count) {
    FeatureBox box(scene.position(vertex[0]));
    for (int k = 0; k < count; ++k) {
        if (k > 0) box.add(scene.position(vertex[k]));
        if (scene.moving) box.add(scene.end(vertex[k]));
    }
    return box;
}

/// Returns the rounding error of the sum a + b, if the sum is finite. The larger summand comes first, so that no
/// intermediate result overflows.
CRUMPLE_HD inline double lost_in_sum(double a, double b) {
    return std::abs(a) < std::abs(b) ? fast_two_sum(b, a).low : fast_two_sum(a, b).low;
}

/// Returns true if low - r <= high + r in real numbers. A sum that overflows to infinity compares correctly with any
/// other.
CRUMPLE_HD inline bool reaches(double low, double high, double r) {
    const double from = low - r, to = high + r;
    if (from != to) return from < to;
    return lost_in_sum(low, -r) <= lost_in_sum(high, r);
}

CRUMPLE_HD inline bool inflated_boxes_overlap(const FeatureBox& a, const FeatureBox& b, double r) {
    for (int axis = 0; axis < 3; ++axis)
        if (!reaches(a.low[axis], b.high[axis], r) || !reaches(b.low[axis], a.high[axis], r)) return false;
    return true;
}

}  // namespace crumple
