#pragma once

// Balls around triangles, and the rule by which balls join clusters: the stages `bounds` and `subdivide` for a single
// triangle (docs/bounds.md, docs/subdivide.md). Compiled for host and device.

#include "geometry/inflation.h"
#include "geometry/vec.h"

namespace crumple {

/// Ball that contains a primitive: centre and radius (eq. 5 of [MZ], the paper cited in ARCHITECTURE.md, but with a
/// radius for each primitive).
struct alignas(16) Ball {
    float x, y, z, r;
};

/// Factor and summand that widen a computed radius by more than its rounding errors. The factor covers the roundings of
/// the radius; the summand covers corners that were rounded from float64, each coordinate by at most 2^-25, because
/// coordinates are at most 1 in magnitude.
inline constexpr float ball_factor = 1.000002f, ball_slack = 4e-7f;

CRUMPLE_HD inline Ball ball_of(const Vec3f& p, const Vec3f& q, const Vec3f& r) {
    const Vec3f c = (1.0f / 3.0f) * (p + q + r);
    const float r2 = max(dot(p - c, p - c), max(dot(q - c, q - c), dot(r - c, r - c)));
    return {c.x, c.y, c.z, std::sqrt(r2) * ball_factor + ball_slack};
}

/// Returns a ball that contains a triangle's swept volume from the start to the end of a step, widened by the
/// inflation.
CRUMPLE_HD inline Ball swept_ball(const Vec3f (&start)[3], const Vec3f (&end)[3], const Inflation& inflation) {
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

/// Returns a ball that contains the box of a triangle's swept volume, inflated on all sides.
CRUMPLE_HD inline Ball ball_of_box(const Vec3f (&start)[3], const Vec3f (&end)[3], const Inflation& inflation) {
    Vec3f low = min(start[0], end[0]), high = max(start[0], end[0]);
    for (int k = 1; k < 3; ++k) low = min(low, min(start[k], end[k])), high = max(high, max(start[k], end[k]));
    const Vec3f c = 0.5f * (low + high);
    const float more = inflation(0);
    const Vec3f half = max(high - c, c - low) + Vec3f{more, more, more};
    return {c.x, c.y, c.z, std::sqrt(dot(half, half)) * ball_factor + ball_slack};
}

/// Returns the factor of the radius in the bisector rule (see joins()): twice the distance of two centres, widened for
/// rounding errors. `between`: difference of the two centres.
CRUMPLE_HD inline float bisector_radius_factor(const Vec3f& between) {
    return 2.00001f * std::sqrt(dot(between, between)) + 1e-22f;
}

/// Factor that widens the nearest centre's squared distance in the bisector rule, to cover rounding errors.
inline constexpr float bisector_factor = 1.000002f;

/// True if a ball of radius r may contain a point whose nearest cluster centre is v_k. Bisector rule: d_k^2 - d_m^2 <=
/// 2 r |v_k - v_m|, where v_m is the cluster centre nearest to the ball's centre, and d_k and d_m are the distances of
/// v_k and v_m from the ball's centre. Factors cover the roundings. `d2`, `nearest_d2`: d_k^2 and d_m^2; `reach`:
/// bisector_radius_factor() of v_k and v_m.
CRUMPLE_HD inline bool joins(float d2, float nearest_d2, float r, float reach) {
    return !(d2 > nearest_d2 * bisector_factor + r * reach);
}

}  // namespace crumple
