#pragma once

// Additions to counters in device memory, with one atomic for all threads of a block: a device serialises atomics on
// one address, at about one per nanosecond, and the thousands of warps of a kernel reach the same place at about the
// same time. All threads of a block call these functions together, and may call them again with the same shared memory.

#include "backends/cuda/device/runtime.h"

namespace crumple::cuda {

/// Shared memory of the functions below, for blocks of at most 256 threads.
struct BlockShared {
    unsigned long long by_warp[8];
    unsigned long long first;
};

/// Reserves places in a list by adding the numbers of all warps to *counter. Returns the first place of the caller's
/// warp; its lanes pass the same number. Like append(), it may exceed the capacity of the list.
__device__ inline unsigned long long reserve_by_block(unsigned long long places, unsigned long long* counter,
                                                      BlockShared& shared) {
    const unsigned warp = threadIdx.x / 32, warps = blockDim.x / 32;
    if (threadIdx.x % 32 == 0) shared.by_warp[warp] = places;
    __syncthreads();
    if (threadIdx.x == 0) {
        unsigned long long sum = 0;
        for (unsigned w = 0; w < warps; ++w) sum += shared.by_warp[w];
        shared.first = sum ? atomicAdd(counter, sum) : 0;
    }
    __syncthreads();
    unsigned long long place = shared.first;
    for (unsigned w = 0; w < warp; ++w) place += shared.by_warp[w];
    __syncthreads();  // the next call overwrites what this one reads
    return place;
}

/// Adds the values of all threads to *counter.
__device__ inline void add_by_block(unsigned long long value, unsigned long long* counter, BlockShared& shared) {
    for (int lanes = 16; lanes > 0; lanes /= 2) value += __shfl_xor_sync(whole_warp, value, lanes);
    if (threadIdx.x % 32 == 0) shared.by_warp[threadIdx.x / 32] = value;
    __syncthreads();
    if (threadIdx.x == 0) {
        unsigned long long sum = 0;
        for (unsigned w = 0; w < blockDim.x / 32; ++w) sum += shared.by_warp[w];
        if (sum) atomicAdd(counter, sum);
    }
    __syncthreads();
}

}  // namespace crumple::cuda
