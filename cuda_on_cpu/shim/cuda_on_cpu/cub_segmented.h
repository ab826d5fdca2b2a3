#pragma once

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_sort.h"

namespace cuda_on_cpu {

/// Sorts each segment [begin_offsets[s], end_offsets[s]). Output outside all segments is left unchanged.
template <class Key, class Value, class N, class M, class Begin, class End>
cudaError_t segmented_sort(const char* name, void* storage, std::size_t& bytes, const Key* keys, Key* keys_out,
                           const Value* values, Value* values_out, N n, M segments, Begin begin_offsets,
                           End end_offsets, SortOrder order, cudaStream_t stream) {
    const std::size_t count = count_of(segments);
    const std::size_t items = count_of(n);
    return device_primitive(name, storage, bytes, sort_bytes<Key, Value>(items, false) + count * 8, stream, [=] {
        for (std::size_t s = 0; s < count; ++s) {
            const auto first = count_of(begin_offsets[s]), last = count_of(end_offsets[s]);
            if (last > items) fail("%s: segment %zu ends at %zu of %zu items", name, s, last, items);
            if (first < last) sort_range(keys, keys_out, values, values_out, first, last, order);
        }
    });
}

}  // namespace cuda_on_cpu
