#pragma once

// Calls of the profiler: the machine counts the work of the kernels in between, if its settings say so.

#include "cuda_on_cpu/machine/counts.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_types.h"

inline cudaError_t cudaProfilerStart() {
    cuda_on_cpu::start_of_profile();
    return cudaSuccess;
}
inline cudaError_t cudaProfilerStop() {
    cuda_on_cpu::end_of_profile();
    return cudaSuccess;
}
