#pragma once

// Launches, attributes and occupancy of kernels.

#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "cuda_on_cpu/machine/launch.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_types.h"

template <class... Parameters, class... Arguments>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t* config, void (*kernel)(Parameters...),
                               Arguments&&... arguments) {
    static_assert((std::is_trivially_copyable_v<Parameters> && ...), "parameters reach a device by memcpy");
    static_assert(sizeof...(Parameters) == sizeof...(Arguments));
    static_assert((sizeof(Parameters) + ... + 0) <= 32764, "the limit of compute capability 7.0 and later");
    const auto values = std::make_shared<const std::tuple<Parameters...>>(std::forward<Arguments>(arguments)...);
    std::vector<const void*> addresses = std::apply(
        [](const Parameters&... each) { return std::vector<const void*>{static_cast<const void*>(&each)...}; },
        *values);
    return cuda_on_cpu::launch(
        *config, reinterpret_cast<const void*>(kernel), [kernel, values] { std::apply(kernel, *values); },
        std::move(addresses));
}

template <class... Parameters>
cudaError_t cudaLaunchKernel(void (*kernel)(Parameters...), dim3 grid, dim3 block, void** arguments,
                             std::size_t shared_bytes = 0, cudaStream_t stream = nullptr) {
    cudaLaunchConfig_t config{};
    config.gridDim = grid;
    config.blockDim = block;
    config.dynamicSmemBytes = shared_bytes;
    config.stream = stream;
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
        return cudaLaunchKernelEx(&config, kernel, *static_cast<Parameters*>(arguments[i])...);
    }
    (std::index_sequence_for<Parameters...>());
}

template <class... Parameters>
cudaError_t cudaFuncSetAttribute(void (*kernel)(Parameters...), cudaFuncAttribute attribute, int value) {
    return cuda_on_cpu::set_attribute(reinterpret_cast<const void*>(kernel), attribute, value);
}
template <class... Parameters>
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* attributes, void (*kernel)(Parameters...)) {
    return cuda_on_cpu::get_attributes(*attributes, reinterpret_cast<const void*>(kernel));
}
template <class... Parameters>
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, void (*kernel)(Parameters...), int threads,
                                                          std::size_t shared_bytes) {
    return cuda_on_cpu::occupancy(*blocks, reinterpret_cast<const void*>(kernel), threads, shared_bytes);
}
