#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_sort.h"

namespace cub {

/// Stable sorts. With a DoubleBuffer the result lies in the buffer that is the current one afterwards.
struct DeviceRadixSort {
    template <class Key, class Value, class N>
    static cudaError_t SortPairs(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, const Value* values,
                                 Value* values_out, N n, int begin_bit = 0, int end_bit = sizeof(Key) * 8,
                                 cudaStream_t stream = nullptr) {
        return sort(storage, bytes, keys, keys_out, values, values_out, n, {begin_bit, end_bit, false}, false, stream);
    }
    template <class Key, class Value, class N>
    static cudaError_t SortPairsDescending(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out,
                                           const Value* values, Value* values_out, N n, int begin_bit = 0,
                                           int end_bit = sizeof(Key) * 8, cudaStream_t stream = nullptr) {
        return sort(storage, bytes, keys, keys_out, values, values_out, n, {begin_bit, end_bit, true}, false, stream);
    }
    template <class Key, class N>
    static cudaError_t SortKeys(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, N n,
                                int begin_bit = 0, int end_bit = sizeof(Key) * 8, cudaStream_t stream = nullptr) {
        return sort<Key, NullType>(storage, bytes, keys, keys_out, nullptr, nullptr, n, {begin_bit, end_bit, false},
                                   false, stream);
    }
    template <class Key, class N>
    static cudaError_t SortKeysDescending(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, N n,
                                          int begin_bit = 0, int end_bit = sizeof(Key) * 8,
                                          cudaStream_t stream = nullptr) {
        return sort<Key, NullType>(storage, bytes, keys, keys_out, nullptr, nullptr, n, {begin_bit, end_bit, true},
                                   false, stream);
    }
    template <class Key, class Value, class N>
    static cudaError_t SortPairs(void* storage, std::size_t& bytes, DoubleBuffer<Key>& keys,
                                 DoubleBuffer<Value>& values, N n, int begin_bit = 0, int end_bit = sizeof(Key) * 8,
                                 cudaStream_t stream = nullptr) {
        const cudaError_t error = sort(storage, bytes, keys.Current(), keys.Alternate(), values.Current(),
                                       values.Alternate(), n, {begin_bit, end_bit, false}, true, stream);
        if (storage && !error) {
            keys.selector ^= 1;
            values.selector ^= 1;
        }
        return error;
    }
    template <class Key, class N>
    static cudaError_t SortKeys(void* storage, std::size_t& bytes, DoubleBuffer<Key>& keys, N n, int begin_bit = 0,
                                int end_bit = sizeof(Key) * 8, cudaStream_t stream = nullptr) {
        const cudaError_t error = sort<Key, NullType>(storage, bytes, keys.Current(), keys.Alternate(), nullptr,
                                                      nullptr, n, {begin_bit, end_bit, false}, true, stream);
        if (storage && !error) keys.selector ^= 1;
        return error;
    }

   private:
    template <class Key, class Value, class N>
    static cudaError_t sort(void* storage, std::size_t& bytes, const Key* keys, Key* keys_out, const Value* values,
                            Value* values_out, N n, cuda_on_cpu::SortOrder order, bool own_alternate,
                            cudaStream_t stream) {
        const std::size_t count = cuda_on_cpu::count_of(n);
        return cuda_on_cpu::device_primitive(
            "DeviceRadixSort", storage, bytes, cuda_on_cpu::sort_bytes<Key, Value>(count, own_alternate), stream,
            [=] { cuda_on_cpu::sort_range(keys, keys_out, values, values_out, 0, count, order); });
    }
};

}  // namespace cub
