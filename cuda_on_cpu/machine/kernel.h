#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/vector_types.h"

namespace cuda_on_cpu {

/// Kernel launch: number of threads, bytes of shared memory, and the body that each thread runs.
struct Kernel {
    dim3 grid, block;
    std::size_t shared_bytes = 0;
    const void* function = nullptr;       ///< identifies the kernel
    std::vector<const void*> parameters;  ///< addresses of the kernel's arguments
    std::function<void()> body;
};

/// Addresses of the happens-before edges between the host and the threads of one launch: `begin` from the host to the
/// threads, `end` from the threads to the host. They are two, because a thread that ends must not appear to precede one
/// that starts.
struct LaunchEdges {
    char begin = 0, end = 0;
};

/// Runs all blocks of a launch on the machine's workers, and returns when they have ended.
void run_grid(const Kernel& kernel);

}  // namespace cuda_on_cpu
