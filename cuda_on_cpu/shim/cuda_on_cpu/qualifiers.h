#pragma once

// CUDA's words that mean nothing to a host compiler, or something of its own.

#define __global__
#define __device__
#define __host__
#define __grid_constant__
#define __launch_bounds__(...)
#define __forceinline__ inline __attribute__((always_inline))
#define __align__(n) __attribute__((aligned(n)))

// A variable of this kind would have no place of its own for each block, no rubbish in it and no guard behind it.
#define __shared__ \
    static_assert(false, "put shared variables into one struct, and ask dynamic_shared<Struct>() for it");
