#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_segmented.h"

namespace cub {

/// Stable sorts of each segment.
struct DeviceSegmentedRadixSort {
    template <class Key, class Value, class N, class M, class Begin, class End>
    static cudaError_t SortPairs(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, const Value* values,
                                 Value* values_out, N n, M segments, Begin begin_offsets, End end_offsets,
                                 int begin_bit = 0, int end_bit = sizeof(Key) * 8, cudaStream_t stream = nullptr) {
        return cuda_on_cpu::segmented_sort("DeviceSegmentedRadixSort", storage, bytes, keys, keys_out, values,
                                           values_out, n, segments, begin_offsets, end_offsets, {begin_bit, end_bit},
                                           stream);
    }
    template <class Key, class N, class M, class Begin, class End>
    static cudaError_t SortKeys(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, N n, M segments,
                                Begin begin_offsets, End end_offsets, int begin_bit = 0, int end_bit = sizeof(Key) * 8,
                                cudaStream_t stream = nullptr) {
        return cuda_on_cpu::segmented_sort<Key, NullType>("DeviceSegmentedRadixSort", storage, bytes, keys, keys_out,
                                                          nullptr, nullptr, n, segments, begin_offsets, end_offsets,
                                                          {begin_bit, end_bit}, stream);
    }
};

}  // namespace cub
