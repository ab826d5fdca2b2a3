#pragma once

// CUDA's qualifiers, which mean nothing to a host compiler, or something else.

#define __global__
#define __device__
#define __host__
#define __grid_constant__
#define __launch_bounds__(...)
#define __forceinline__ inline __attribute__((always_inline))
#define __align__(n) __attribute__((aligned(n)))

// A __shared__ variable would exist once, not once per block, without rubbish in it and without a guard page behind it.
#define __shared__ \
    static_assert(false, "put shared variables into one struct, and get it from dynamic_shared<Struct>()");
