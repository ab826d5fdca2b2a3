#pragma once

// Stage `align`: the frame in which each leaf is swept, by PCA of its centroids ([MZ] sec. 3, eq. 1), and what a
// triangle looks like there. Margins are derived in docs/align.md.

#include "engine/cuda/layout.h"
#include "engine/cuda/runtime.h"
#include "model/scene.h"

namespace crumple::cuda {

/// Frames of leaves [0, leaves), whose members lie at [first[leaf], first[leaf + 1]).
void make_frames(const Geometry& geometry, cudaStream_t stream, int leaves, const unsigned long long* first,
                 const std::int32_t* triangle, const Scene& scene, const Points& points, const Ball* balls,
                 Frame* frames);

/// The normalised corners of a triangle.
template <class T>
__device__ void load_corners(const Row<T>* rows, const std::int32_t* corner, Vec3d p[3]) {
    for (int k = 0; k < 3; ++k) {
        const Row<T> row = rows[corner[k]];
        p[k] = {row.x, row.y, row.z};
    }
}

}  // namespace crumple::cuda
