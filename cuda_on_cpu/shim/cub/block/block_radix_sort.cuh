#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cub/util_type.cuh>
#include <utility>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/radix.h"

namespace cub {

/// Sorts keys, and values if there are any, in a blocked arrangement: thread t holds items t * N to t * N + N - 1.
template <class Key, int X, int N, class Value = NullType, int RadixBits = 4, bool Memoize = true, int... More>
class BlockRadixSort {
    static constexpr unsigned threads = X;
    struct Mine {
        Key* keys;
        Value* values;
    };

   public:
    using TempStorage = cuda_on_cpu::CubStorage<threads, threads * N * std::max(sizeof(Key), sizeof(Value)) + 256>;

    explicit BlockRadixSort(TempStorage& storage, const char* file = __builtin_FILE(), int line = __builtin_LINE())
        : storage_(storage), site_{"BlockRadixSort", file, line} {}

    void Sort(Key (&keys)[N], int begin = 0, int end = bits) { sort(keys, nullptr, begin, end, false, false); }
    void Sort(Key (&keys)[N], Value (&values)[N], int begin = 0, int end = bits) {
        sort(keys, values, begin, end, false, false);
    }
    void SortDescending(Key (&keys)[N], int begin = 0, int end = bits) { sort(keys, nullptr, begin, end, true, false); }
    void SortDescending(Key (&keys)[N], Value (&values)[N], int begin = 0, int end = bits) {
        sort(keys, values, begin, end, true, false);
    }
    /// Sorts. Afterwards thread t holds items t, t + threads, t + 2 threads, ...
    void SortBlockedToStriped(Key (&keys)[N], int begin = 0, int end = bits) {
        sort(keys, nullptr, begin, end, false, true);
    }
    void SortBlockedToStriped(Key (&keys)[N], Value (&values)[N], int begin = 0, int end = bits) {
        sort(keys, values, begin, end, false, true);
    }

   private:
    static constexpr int bits = sizeof(Key) * 8;

    void sort(Key* keys, Value* values, int begin, int end, bool descending, bool striped) {
        Mine mine{keys, values};
        cuda_on_cpu::block_primitive<threads>(site_, storage_, mine, [&](Mine* const* all) {
            std::vector<std::pair<Key, Value>> items;
            for (unsigned t = 0; t < threads; ++t)
                for (int i = 0; i < N; ++i)
                    items.emplace_back(all[t]->keys[i], all[t]->values ? all[t]->values[i] : Value{});
            std::stable_sort(items.begin(), items.end(), [&](const auto& a, const auto& b) {
                const auto x = cuda_on_cpu::digit(a.first, begin, end), y = cuda_on_cpu::digit(b.first, begin, end);
                return descending ? y < x : x < y;
            });
            for (unsigned t = 0; t < threads; ++t)
                for (unsigned i = 0; i < N; ++i) {
                    const auto& item = items[striped ? i * threads + t : t * N + i];
                    all[t]->keys[i] = item.first;
                    if (all[t]->values) all[t]->values[i] = item.second;
                }
        });
    }

    TempStorage& storage_;
    cuda_on_cpu::Site site_;
};

}  // namespace cub
