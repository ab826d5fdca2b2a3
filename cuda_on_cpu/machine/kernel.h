#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/vector_types.h"

namespace cuda_on_cpu {

/// A launch: how many threads, how much shared memory, and what each thread runs.
struct Kernel {
    dim3 grid, block;
    std::size_t shared_bytes = 0;
    const void* function = nullptr;       ///< names the kernel: attributes and graph updates ask for it
    std::vector<const void*> parameters;  ///< addresses
    std::function<void()> body;
};

/// Where happens-before edges between the host and the threads of one launch meet: begin holds what the launch saw,
/// end what the threads left. They are two, because a thread that ends must not seem to precede one that starts.
struct LaunchEdges {
    char begin = 0, end = 0;
};

/// Runs all blocks of a launch on the machine's workers, and returns when they have ended.
void run_grid(const Kernel& kernel);

}  // namespace cuda_on_cpu
