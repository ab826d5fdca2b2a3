#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_segmented.h"

namespace cub {

/// Sorts of each segment. StableSortPairs is stable. SortPairs is not: it reverses pairs with equal keys.
struct DeviceSegmentedSort {
    template <class Key, class Value, class N, class M, class Begin, class End>
    static cudaError_t SortPairs(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, const Value* values,
                                 Value* values_out, N n, M segments, Begin begin_offsets, End end_offsets,
                                 cudaStream_t stream = nullptr) {
        return cuda_on_cpu::segmented_sort("DeviceSegmentedSort", storage, bytes, keys, keys_out, values, values_out, n,
                                           segments, begin_offsets, end_offsets,
                                           {0, 64, false, cuda_on_cpu::Ties::reverse}, stream);
    }
    template <class Key, class Value, class N, class M, class Begin, class End>
    static cudaError_t StableSortPairs(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out,
                                       const Value* values, Value* values_out, N n, M segments, Begin begin_offsets,
                                       End end_offsets, cudaStream_t stream = nullptr) {
        return cuda_on_cpu::segmented_sort("DeviceSegmentedSort", storage, bytes, keys, keys_out, values, values_out, n,
                                           segments, begin_offsets, end_offsets, {}, stream);
    }
    template <class Key, class N, class M, class Begin, class End>
    static cudaError_t SortKeys(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, N n, M segments,
                                Begin begin_offsets, End end_offsets, cudaStream_t stream = nullptr) {
        return cuda_on_cpu::segmented_sort<Key, NullType>("DeviceSegmentedSort", storage, bytes, keys, keys_out,
                                                          nullptr, nullptr, n, segments, begin_offsets, end_offsets, {},
                                                          stream);
    }
};

}  // namespace cub
