#include "cuda_on_cpu/machine/launch.h"

#include <algorithm>
#include <map>
#include <utility>

#include "cuda_on_cpu/machine/call.h"
#include "cuda_on_cpu/machine/device_limits.h"
#include "cuda_on_cpu/machine/kernel.h"

namespace cuda_on_cpu {
namespace {

/// Bytes of dynamic shared memory allowed by cudaFuncSetAttribute, by kernel. Other kernels may have 48 KiB.
std::map<const void*, std::size_t>& shared_limits() {
    static std::map<const void*, std::size_t> instance;
    return instance;
}

std::size_t shared_limit(const void* kernel) {
    const auto found = shared_limits().find(kernel);
    return found == shared_limits().end() ? limits::shared_bytes_per_block : found->second;
}

bool within(const dim3& d, unsigned x, unsigned y, unsigned z) {
    return d.x >= 1 && d.y >= 1 && d.z >= 1 && d.x <= x && d.y <= y && d.z <= z;
}

cudaError_t check(const cudaLaunchConfig_t& config, const void* kernel) {
    const dim3& block = config.blockDim;
    if (!kernel) return cudaErrorInvalidDeviceFunction;
    if (!within(config.gridDim, limits::grid_x, limits::grid_y, limits::grid_z) ||
        !within(block, limits::block_x, limits::block_y, limits::block_z) ||
        block.x * block.y * block.z > static_cast<unsigned>(limits::threads_per_block))
        return cudaErrorInvalidValue;  // as cudaLaunchKernelEx does; <<<>>> gives cudaErrorInvalidConfiguration
    if (config.dynamicSmemBytes > shared_limit(kernel)) return cudaErrorInvalidValue;
    for (unsigned i = 0; i < config.numAttrs; ++i) switch (config.attrs[i].id) {
            case cudaLaunchAttributeIgnore:
            case cudaLaunchAttributePriority:
            case cudaLaunchAttributeProgrammaticStreamSerialization:
                break;
            default:
                return cudaErrorNotSupported;
        }
    return cudaSuccess;
}

}  // namespace

WorkCount& work_count() {
    static WorkCount instance;
    return instance;
}

cudaError_t launch(const cudaLaunchConfig_t& config, const void* kernel, std::function<void()> body,
                   std::vector<const void*> parameters) {
    return call([&] {
        if (const cudaError_t error = check(config, kernel)) return error;
        int& countdown = settings().launches_before_failure;
        if (countdown >= 0 && countdown-- == 0) return cudaErrorMemoryAllocation;
        ++work_count().launches;
        Kernel k{config.gridDim, config.blockDim,       config.dynamicSmemBytes,
                 kernel,         std::move(parameters), std::move(body)};
        return enqueue(config.stream, {Work::Kind::kernel, kernel, [k = std::move(k)] { run_grid(k); }});
    });
}

cudaError_t enqueue_device_work(cudaStream_t stream, const void* function, std::function<void()> run) {
    return call([&] { return enqueue(stream, {Work::Kind::kernel, function, std::move(run)}); });
}

cudaError_t set_attribute(const void* kernel, cudaFuncAttribute attribute, int value) {
    return call([&] {
        if (!kernel) return cudaErrorInvalidDeviceFunction;
        if (attribute != cudaFuncAttributeMaxDynamicSharedMemorySize) return cudaSuccess;
        if (value < 0 || value > static_cast<int>(limits::shared_bytes_per_block_optin)) return cudaErrorInvalidValue;
        shared_limits()[kernel] = static_cast<std::size_t>(value);
        return cudaSuccess;
    });
}

cudaError_t get_attributes(cudaFuncAttributes& attributes, const void* kernel) {
    return call([&] {
        if (!kernel) return cudaErrorInvalidDeviceFunction;
        attributes = {};
        attributes.maxThreadsPerBlock = limits::threads_per_block;
        attributes.numRegs = settings().registers;
        attributes.ptxVersion = attributes.binaryVersion = 90;
        attributes.maxDynamicSharedSizeBytes = static_cast<int>(shared_limit(kernel));
        return cudaSuccess;
    });
}

cudaError_t occupancy(int& blocks, const void* kernel, int threads, std::size_t shared_bytes) {
    return call([&] {
        if (!kernel) return cudaErrorInvalidDeviceFunction;
        if (threads < 1) return cudaErrorInvalidValue;
        const std::size_t per_block = shared_bytes + 1024;  // the system reserves 1 KiB per block
        const int by_registers = limits::registers / settings().registers / threads;
        const auto by_memory = static_cast<int>(limits::shared_bytes_per_multiprocessor / per_block);
        blocks = threads > limits::threads_per_block || shared_bytes > shared_limit(kernel)
                     ? 0
                     : std::min({limits::blocks_per_multiprocessor, limits::threads_per_multiprocessor / threads,
                                 by_registers, by_memory});
        return cudaSuccess;
    });
}

}  // namespace cuda_on_cpu
