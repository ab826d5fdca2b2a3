#pragma once

// Sort that all counterparts of CUB's device-wide sorts use.

#include <algorithm>
#include <cstddef>
#include <cub/util_type.cuh>
#include <numeric>
#include <type_traits>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_device.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/radix.h"

namespace cuda_on_cpu {

enum class Ties { keep_order, reverse };

struct SortOrder {
    int begin_bit = 0, end_bit = 64;
    bool descending = false;
    /// Order of equal keys. Unstable sorts reverse it, so that code that relies on stability fails.
    Ties ties = Ties::keep_order;
};

/// Sorts items [first, last) from the input to the output, which must not overlap. Values may be null.
template <class Key, class Value>
void sort_range(const Key* keys, Key* keys_out, const Value* values, Value* values_out, std::size_t first,
                std::size_t last, SortOrder order) {
    std::vector<std::size_t> from(last - first);
    std::iota(from.begin(), from.end(), first);
    if (order.ties == Ties::reverse) std::reverse(from.begin(), from.end());
    std::stable_sort(from.begin(), from.end(), [&](std::size_t a, std::size_t b) {
        const auto x = digit(keys[a], order.begin_bit, order.end_bit),
                   y = digit(keys[b], order.begin_bit, order.end_bit);
        return order.descending ? y < x : x < y;
    });
    for (std::size_t i = 0; i < from.size(); ++i) {
        keys_out[first + i] = keys[from[i]];
        if constexpr (!std::is_same_v<Value, cub::NullType>)
            if (values) values_out[first + i] = values[from[i]];
    }
}

/// Returns the bytes of temporary storage of a sort. `own_alternate`: true if the caller has a second buffer
/// (DoubleBuffer); otherwise the storage must hold a second copy of the data.
template <class Key, class Value>
std::size_t sort_bytes(std::size_t n, bool own_alternate) {
    return n / 64 + (own_alternate ? 0 : n * (sizeof(Key) + sizeof(Value)));
}

}  // namespace cuda_on_cpu
