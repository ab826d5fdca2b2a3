#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"

namespace cub {

/// Reduces one value of each lane. Only the first lane gets the result; the others get rubbish.
template <class T, int Lanes = 32>
class WarpReduce {
   public:
    using TempStorage = cuda_on_cpu::CubStorage<Lanes, Lanes * sizeof(T) + 16>;

    explicit WarpReduce(TempStorage& storage, const char* file = __builtin_FILE(), int line = __builtin_LINE())
        : storage_(storage), site_{"WarpReduce", file, line} {}

    T Sum(T in) { return Reduce(in, cuda_on_cpu::Plus()); }
    T Sum(T in, int valid) { return Reduce(in, cuda_on_cpu::Plus(), valid); }
    template <class Operation>
    T Reduce(T in, Operation operation) {
        return Reduce(in, operation, Lanes);
    }
    /// Reduces the values of the first `valid` lanes.
    template <class Operation>
    T Reduce(T in, Operation operation, int valid) {
        cuda_on_cpu::warp_primitive<Lanes>(site_, storage_, in, [&](T* const* all) {
            T result = *all[0];
            for (int i = 1; i < Lanes; ++i) {
                if (i < valid) result = operation(result, *all[i]);
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
