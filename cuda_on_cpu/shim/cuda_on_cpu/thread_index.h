#pragma once

#include "cuda_on_cpu/shim/cuda_on_cpu/vector_types.h"

// Variables, not macros: other structs have members of these names. Each OS thread runs one CUDA thread at a time.
inline constinit thread_local uint3 threadIdx{}, blockIdx{};
inline constinit thread_local dim3 blockDim, gridDim;
inline constexpr int warpSize = 32;
