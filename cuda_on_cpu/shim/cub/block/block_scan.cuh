#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"

namespace cub {

enum BlockScanAlgorithm { BLOCK_SCAN_RAKING, BLOCK_SCAN_RAKING_MEMOIZE, BLOCK_SCAN_WARP_SCANS };

template <class T, int X, BlockScanAlgorithm = BLOCK_SCAN_RAKING, int Y = 1, int Z = 1>
class BlockScan {
    static constexpr unsigned threads = X * Y * Z;
    using Mine = cuda_on_cpu::Scan<T>;
    using Plus = cuda_on_cpu::Plus;

   public:
    using TempStorage = cuda_on_cpu::CubStorage<threads, threads * sizeof(T) + 64>;

    explicit BlockScan(TempStorage& storage, const char* file = __builtin_FILE(), int line = __builtin_LINE())
        : storage_(storage), site_{"BlockScan", file, line} {}

    void ExclusiveSum(T in, T& out) { exclusive(&in, &out, 1, zero(), Plus()); }
    void ExclusiveSum(T in, T& out, T& aggregate) { aggregate = exclusive(&in, &out, 1, zero(), Plus()); }
    template <int N>
    void ExclusiveSum(T (&in)[N], T (&out)[N]) {
        exclusive(in, out, N, zero(), Plus());
    }
    template <int N>
    void ExclusiveSum(T (&in)[N], T (&out)[N], T& aggregate) {
        aggregate = exclusive(in, out, N, zero(), Plus());
    }
    void InclusiveSum(T in, T& out) { inclusive(&in, &out, 1, Plus()); }
    void InclusiveSum(T in, T& out, T& aggregate) { aggregate = inclusive(&in, &out, 1, Plus()); }
    template <int N>
    void InclusiveSum(T (&in)[N], T (&out)[N]) {
        inclusive(in, out, N, Plus());
    }
    template <int N>
    void InclusiveSum(T (&in)[N], T (&out)[N], T& aggregate) {
        aggregate = inclusive(in, out, N, Plus());
    }
    template <class Operation>
    void ExclusiveScan(T in, T& out, T initial, Operation operation) {
        exclusive(&in, &out, 1, &initial, operation);
    }
    template <class Operation>
    void ExclusiveScan(T in, T& out, T initial, Operation operation, T& aggregate) {
        aggregate = exclusive(&in, &out, 1, &initial, operation);
    }
    template <int N, class Operation>
    void ExclusiveScan(T (&in)[N], T (&out)[N], T initial, Operation operation) {
        exclusive(in, out, N, &initial, operation);
    }
    template <int N, class Operation>
    void ExclusiveScan(T (&in)[N], T (&out)[N], T initial, Operation operation, T& aggregate) {
        aggregate = exclusive(in, out, N, &initial, operation);
    }
    template <class Operation>
    void InclusiveScan(T in, T& out, Operation operation) {
        inclusive(&in, &out, 1, operation);
    }
    template <class Operation>
    void InclusiveScan(T in, T& out, Operation operation, T& aggregate) {
        aggregate = inclusive(&in, &out, 1, operation);
    }
    template <int N, class Operation>
    void InclusiveScan(T (&in)[N], T (&out)[N], Operation operation) {
        inclusive(in, out, N, operation);
    }
    template <int N, class Operation>
    void InclusiveScan(T (&in)[N], T (&out)[N], Operation operation, T& aggregate) {
        aggregate = inclusive(in, out, N, operation);
    }

   private:
    static const T* zero() {
        static constexpr T value{};
        return &value;
    }
    template <class Operation>
    T exclusive(const T* in, T* out, int items, const T* initial, Operation operation) {
        Mine mine{in, out, items, T{}};
        cuda_on_cpu::block_primitive<threads>(site_, storage_, mine, [&](Mine* const* all) {
            cuda_on_cpu::exclusive_scan(all, threads, initial, operation);
        });
        return mine.aggregate;
    }
    template <class Operation>
    T inclusive(const T* in, T* out, int items, Operation operation) {
        Mine mine{in, out, items, T{}};
        cuda_on_cpu::block_primitive<threads>(
            site_, storage_, mine, [&](Mine* const* all) { cuda_on_cpu::inclusive_scan(all, threads, operation); });
        return mine.aggregate;
    }

    TempStorage& storage_;
    cuda_on_cpu::Site site_;
};

}  // namespace cub
