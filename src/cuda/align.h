#pragma once

// Stage `align`: the frame in which each leaf is swept, by PCA of its centroids ([MZ] sec. 3, eq. 1), and what a
// triangle looks like there. Margins are derived in docs/align.md.

#include "cuda/layout.h"
#include "cuda/runtime.h"

namespace crumple::cuda {

inline constexpr float unit_roundoff = 0x1p-24f;  ///< u

/// Frames of leaves [0, leaves), whose members lie at [first[leaf], first[leaf + 1]).
void make_frames(const Geometry& geometry, cudaStream_t stream, int leaves, const unsigned long long* first,
                 const std::int32_t* triangle, const Ball* balls, Frame* frames);

/// An upper bound of any coordinate of the ball's triangle, relative to the frame's origin.
CRUMPLE_HD inline float reach_of(const Ball& ball, const Frame& frame) {
    return (largest(abs(Vec3f{ball.x, ball.y, ball.z} - frame.origin)) + ball.r) * 1.00001f;
}

/// How far the corners may be, by their rounding, from where they seem to be in the frame.
CRUMPLE_HD inline float margin_of(float reach, const Frame& frame) {
    return reach > frame.big ? frame.margin + 16 * unit_roundoff * reach : frame.margin;
}

/// A corner relative to the frame's origin, rounded once.
CRUMPLE_HD inline Vec3f relative(const Row<float>& p, Vec3f origin) {
    return {p.x - origin.x, p.y - origin.y, p.z - origin.z};
}
CRUMPLE_HD inline Vec3f relative(const Row<double>& p, Vec3f origin) {
    return {static_cast<float>(p.x - origin.x), static_cast<float>(p.y - origin.y), static_cast<float>(p.z - origin.z)};
}

/// The extent of three points along an axis, widened by the margin.
struct Interval {
    float low, high;
};
CRUMPLE_HD inline Interval extent(const Vec3f q[3], Vec3f axis, float margin) {
    const float s = dot(axis, q[0]), t = dot(axis, q[1]), u = dot(axis, q[2]);
    return {min(s, min(t, u)) - margin, max(s, max(t, u)) + margin};
}

}  // namespace crumple::cuda
