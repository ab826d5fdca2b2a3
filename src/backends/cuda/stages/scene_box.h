#pragma once

// Reduction of vertices to the scene's box, for kernels that read all vertices.

#include "backends/cuda/stages/bounds.h"

namespace crumple::cuda {

/// Box of each warp of a block, by axis.
struct BoxShared {
    unsigned long long low[3][32], high[3][32];
};

/// Widens the box by the boxes of all threads of the block, which call it together.
__device__ inline void widen(SceneBox* box, const Vec3d& low, const Vec3d& high, BoxShared& shared) {
    for (int axis = 0; axis < 3; ++axis) {
        unsigned long long least = ordered(low[axis]), greatest = ordered(high[axis]);
        for (int lanes = 16; lanes > 0; lanes /= 2) {
            least = min(least, __shfl_xor_sync(whole_warp, least, lanes));
            greatest = max(greatest, __shfl_xor_sync(whole_warp, greatest, lanes));
        }
        if (threadIdx.x % 32 != 0) continue;
        shared.low[axis][threadIdx.x / 32] = least;
        shared.high[axis][threadIdx.x / 32] = greatest;
    }
    __syncthreads();
    if (threadIdx.x >= 3) return;
    const unsigned axis = threadIdx.x;
    unsigned long long least = shared.low[axis][0], greatest = shared.high[axis][0];
    for (unsigned warp = 1; warp < blockDim.x / 32; ++warp) {
        least = min(least, shared.low[axis][warp]);
        greatest = max(greatest, shared.high[axis][warp]);
    }
    atomicMin(&box->low[axis], least);
    atomicMax(&box->high[axis], greatest);
}

}  // namespace crumple::cuda
