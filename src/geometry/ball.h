#pragma once

// Balls around triangles and the rule by which they join clusters: stages `bounds` and `subdivide` for one of them
// (docs/bounds.md, docs/subdivide.md). Compiled for host and device.

#include "geometry/inflation.h"
#include "geometry/vec.h"

namespace crumple {

/// A ball that holds a primitive: centroid and radius ([MZ] eq. 5, but one for each).
struct alignas(16) Ball {
    float x, y, z, r;
};

/// Widen a computed radius. Coordinates are at most 1: differences and the corners of float64 input err by at most 2 u.
inline constexpr float ball_factor = 1.000002f, ball_slack = 4e-7f;

CRUMPLE_HD inline Ball ball_of(const Vec3f& p, const Vec3f& q, const Vec3f& r) {
    const Vec3f c = (1.0f / 3.0f) * (p + q + r);
    const float r2 = max(dot(p - c, p - c), max(dot(q - c, q - c), dot(r - c, r - c)));
    return {c.x, c.y, c.z, std::sqrt(r2) * ball_factor + ball_slack};
}

/// A ball that holds a triangle all the way from the start to the end of a step, widened by the inflation.
CRUMPLE_HD inline Ball ball_of_way(const Vec3f (&start)[3], const Vec3f (&end)[3], const Inflation& inflation) {
    const Vec3f c = (1.0f / 6.0f) * ((start[0] + start[1] + start[2]) + (end[0] + end[1] + end[2]));
    float r2 = 0, way2 = 0;
    for (int k = 0; k < 3; ++k) {
        const Vec3f p = start[k] - c, q = end[k] - c, step = end[k] - start[k];
        r2 = max(r2, max(dot(p, p), dot(q, q)));
        way2 = max(way2, dot(step, step));
    }
    const float more = inflation(std::sqrt(way2) * ball_factor + ball_slack);
    return {c.x, c.y, c.z, std::sqrt(r2) * ball_factor + ball_slack + more};
}

/// A ball that holds the box of a triangle's points all the way, widened on all sides.
CRUMPLE_HD inline Ball ball_of_box(const Vec3f (&start)[3], const Vec3f (&end)[3], const Inflation& inflation) {
    Vec3f low = min(start[0], end[0]), high = max(start[0], end[0]);
    for (int k = 1; k < 3; ++k) low = min(low, min(start[k], end[k])), high = max(high, max(start[k], end[k]));
    const Vec3f c = 0.5f * (low + high);
    const float more = inflation(0);
    const Vec3f half = max(high - c, c - low) + Vec3f{more, more, more};
    return {c.x, c.y, c.z, std::sqrt(dot(half, half)) * ball_factor + ball_slack};
}

/// Twice the distance of two centres, widened.
CRUMPLE_HD inline float bisector_reach(const Vec3f& between) {
    return 2.00001f * std::sqrt(dot(between, between)) + 1e-22f;
}

/// Widens the nearest centre's squared distance for the bisector rule.
inline constexpr float bisector_factor = 1.000002f;

/// Bisector rule: d_k^2 - d_min^2 <= 2 r |v_k - v_min|, with factors that cover the roundings: whether a ball of radius
/// r may hold a point that is nearest to centre k. d2: squared distances of its centre to that one, and to the nearest.
CRUMPLE_HD inline bool joins(float d2, float nearest_d2, float r, float reach) {
    return !(d2 > nearest_d2 * bisector_factor + r * reach);
}

}  // namespace crumple
