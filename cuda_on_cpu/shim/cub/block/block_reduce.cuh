#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"

namespace cub {

enum BlockReduceAlgorithm { BLOCK_REDUCE_RAKING_COMMUTATIVE_ONLY, BLOCK_REDUCE_RAKING, BLOCK_REDUCE_WARP_REDUCTIONS };

/// Reduces one or more items of each thread. Only thread 0 gets the result; the others get rubbish.
template <class T, int X, BlockReduceAlgorithm = BLOCK_REDUCE_WARP_REDUCTIONS, int Y = 1, int Z = 1>
class BlockReduce {
    static constexpr unsigned threads = X * Y * Z;

   public:
    using TempStorage = cuda_on_cpu::CubStorage<threads, threads * sizeof(T) + 64>;

    explicit BlockReduce(TempStorage& storage, const char* file = __builtin_FILE(), int line = __builtin_LINE())
        : storage_(storage), site_{"BlockReduce", file, line} {}

    T Sum(T in) { return Reduce(in, cuda_on_cpu::Plus()); }
    T Sum(T in, int valid) { return Reduce(in, cuda_on_cpu::Plus(), valid); }
    template <int N>
    T Sum(T (&in)[N]) {
        return Reduce(in, cuda_on_cpu::Plus());
    }
    template <class Operation>
    T Reduce(T in, Operation operation) {
        return Reduce(in, operation, static_cast<int>(threads));
    }
    template <int N, class Operation>
    T Reduce(T (&in)[N], Operation operation) {
        T own = in[0];
        for (int i = 1; i < N; ++i) own = operation(own, in[i]);
        return Reduce(own, operation);
    }
    /// Reduces the items of the first `valid` threads.
    template <class Operation>
    T Reduce(T in, Operation operation, int valid) {
        cuda_on_cpu::block_primitive<threads>(site_, storage_, in, [&](T* const* all) {
            T result = *all[0];
            for (unsigned i = 1; i < threads; ++i) {
                if (static_cast<int>(i) < valid) result = operation(result, *all[i]);
                cuda_on_cpu::spoil(*all[i]);
            }
            *all[0] = result;
        });
        return in;
    }

   private:
    TempStorage& storage_;
    cuda_on_cpu::Site site_;
};

}  // namespace cub
