#pragma once

// Stage `align`: the frame in which each leaf is swept, by PCA of its centroids ([MZ] sec. 3, eq. 1), and what a
// triangle looks like there. Margins are derived in docs/align.md.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Frames of leaves [0, leaves), by their members. Whatever is brought, they are finite, for the next pass takes them
/// as they are. `along_axes`: with the axes of the coordinates, the first one nearest to where the members spread.
void make_frames(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                 const std::int32_t* triangle, const PreparedScene& scene, const Points& points, const Ball* balls,
                 bool along_axes, BinnedFrame* frames);

/// How far the members reach in frames that were made after they had been listed; finds all reaches 0.
void measure_reach(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                   const Members& members, const PreparedScene& scene, const Primitives& primitives,
                   const Points& points, const Ball* balls, const Frames& frames);

/// An upper bound of any coordinate of the ball's triangle, relative to the origin.
__device__ inline float ball_reach(const Ball& ball, const Vec3f& origin) {
    return (largest(abs(Vec3f{ball.x, ball.y, ball.z} - origin)) + ball.r) * 1.00001f;
}
/// What a triangle counts for in its leaf's reach, if it is big; else `bound`, which its ball has given.
template <class Primitive>
__device__ float exact_reach(const PreparedScene& scene, const Primitive& primitive, const PointRows& points,
                             std::int32_t triangle, const LeafFrame& frame, float bound) {
    Vec3d p[Primitive::corners];
    const auto member =
        primitive.in_frame(points, scene.corners + 3 * static_cast<std::size_t>(triangle), triangle, frame, p);
    return member.big ? member.counted_reach() : bound;
}

}  // namespace crumple::cuda
