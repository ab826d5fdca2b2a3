#pragma once

// The untyped side of a launch: checks, and a place in the stream.

#include <cstddef>
#include <functional>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_types.h"

namespace cuda_on_cpu {

/// Gives the stream a launch, each thread of which runs `body`. `parameters`: addresses of the kernel's, which live as
/// long as `body`.
cudaError_t launch(const cudaLaunchConfig_t& config, const void* kernel, std::function<void()> body,
                   std::vector<const void*> parameters);

/// Numbers of launches of kernels, and of copies, that were given to streams so far.
struct WorkCount {
    std::size_t launches = 0, copies = 0;
};
WorkCount& work_count();

/// Gives a stream something for the device to do that is no launch of ours, such as one of CUB's device-wide
/// primitives. `function` tells one kind from another when a graph is updated.
cudaError_t enqueue_device_work(cudaStream_t stream, const void* function, std::function<void()> run);

cudaError_t set_attribute(const void* kernel, cudaFuncAttribute attribute, int value);
cudaError_t get_attributes(cudaFuncAttributes& attributes, const void* kernel);
cudaError_t occupancy(int& blocks, const void* kernel, int threads, std::size_t shared_bytes);

}  // namespace cuda_on_cpu
