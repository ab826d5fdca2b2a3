#pragma once

// Type-erased part of a launch: checks it and enqueues it in its stream.

#include <cstddef>
#include <functional>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_types.h"

namespace cuda_on_cpu {

/// Enqueues a launch, each thread of which runs `body`. `parameters`: addresses of the kernel's arguments, which must
/// live as long as `body`.
cudaError_t launch(const cudaLaunchConfig_t& config, const void* kernel, std::function<void()> body,
                   std::vector<const void*> parameters);

/// Numbers of kernel launches and of copies enqueued so far.
struct WorkCount {
    std::size_t launches = 0, copies = 0;
};
WorkCount& work_count();

/// Enqueues device work that is no kernel launch, such as one of CUB's device-wide primitives, which `function`
/// identifies.
cudaError_t enqueue_device_work(cudaStream_t stream, const void* function, std::function<void()> run);

cudaError_t set_attribute(const void* kernel, cudaFuncAttribute attribute, int value);
cudaError_t get_attributes(cudaFuncAttributes& attributes, const void* kernel);
cudaError_t occupancy(int& blocks, const void* kernel, int threads, std::size_t shared_bytes);

}  // namespace cuda_on_cpu
