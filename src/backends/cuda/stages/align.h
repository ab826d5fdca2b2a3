#pragma once

// Stage `align`: computes the frame in which each leaf is swept, by PCA of its members' centroids ([MZ] sec. 3, eq. 1),
// and the extent of the members in it: a bound on their |coordinates| relative to the frame's origin. Margins are
// derived in docs/align.md.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Computes the frames of leaves [0, leaves) from their members. Frames are finite even if coordinates are not, because
/// the next pass uses them unchecked. `along_axes`: uses the coordinate axes, first the one nearest to the direction in
/// which the members spread.
void make_frames(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                 const std::int32_t* triangle, const PreparedScene& scene, const Points& points, const Ball* balls,
                 bool along_axes, BinnedFrame* frames);

/// Computes the extent of each leaf's members in a pass without a warm start, whose frames are made after the members
/// have been listed. (In a warm-started pass make_members() computes the extents.) All extents must be 0 before.
void measure_extent(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                    const Members& members, const PreparedScene& scene, const Primitives& primitives,
                    const Points& points, const Ball* balls, const Frames& frames);

/// Returns an upper bound on the |coordinates|, along the scene's axes and relative to `origin`, of a primitive whose
/// ball this is.
__device__ inline float ball_extent(const Ball& ball, const Vec3f& origin) {
    return (largest(abs(Vec3f{ball.x, ball.y, ball.z} - origin)) + ball.r) * 1.00001f;
}
/// Returns what a triangle contributes to its leaf's extent. That is `bound`, which is derived from its ball, or, if
/// the triangle is big (geometry/leaf_frame.h), the small share big_share of its own extent.
template <class Primitive>
__device__ float exact_extent(const PreparedScene& scene, const Primitive& primitive, const PointRows& points,
                              std::int32_t triangle, const LeafFrame& frame, float bound) {
    Vec3d p[Primitive::corners];
    const auto member =
        primitive.in_frame(points, scene.corners + 3 * static_cast<std::size_t>(triangle), triangle, frame, p);
    return member.big ? member.counted_extent() : bound;
}

}  // namespace crumple::cuda
