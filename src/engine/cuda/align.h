#pragma once

// Stage `align`: the frame in which each leaf is swept, by PCA of its centroids ([MZ] sec. 3, eq. 1), and what a
// triangle looks like there. Margins are derived in docs/align.md.

#include "engine/cuda/layout.h"
#include "engine/cuda/runtime.h"
#include "model/scene.h"

namespace crumple::cuda {

/// Frames of leaves [0, leaves), by their members. Whatever is brought, they are finite, for the next pass takes them
/// as they are.
void make_frames(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                 const std::int32_t* triangle, const Scene& scene, const Points& points, const Ball* balls,
                 BinnedFrame* frames);

/// How far the members reach in frames that were made after they had been listed; finds all reaches 0.
void measure_reach(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                   const Members& members, const Scene& scene, const Points& points, const Ball* balls,
                   const Frames& frames);

/// An upper bound of any coordinate of the ball's triangle, relative to the origin.
__device__ inline float ball_reach(const Ball& ball, const Vec3f& origin) {
    return (largest(abs(Vec3f{ball.x, ball.y, ball.z} - origin)) + ball.r) * 1.00001f;
}
/// What a triangle counts for in its leaf's reach, if it is big; else `bound`, which its ball has given.
__device__ inline float exact_reach(const Scene& scene, const PointRows& points, std::int32_t triangle,
                                    const LeafFrame& frame, float bound) {
    const std::int32_t* corner = scene.corners + 3 * static_cast<std::size_t>(triangle);
    const Vec3d p[3] = {points[corner[0]], points[corner[1]], points[corner[2]]};
    const InFrame<3> member(p, frame);
    return member.big ? member.counted_reach() : bound;
}

/// The normalised corners of a triangle.
template <class T>
__device__ void load_corners(const Row<T>* rows, const std::int32_t* corner, Vec3d p[3]) {
    for (int k = 0; k < 3; ++k) {
        const Row<T> row = rows[corner[k]];
        p[k] = {row.x, row.y, row.z};
    }
}

}  // namespace crumple::cuda
