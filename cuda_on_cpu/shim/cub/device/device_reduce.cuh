#pragma once

#include <cuda_runtime.h>

#include <limits>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_device.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"

namespace cub {

struct DeviceReduce {
    /// Sums in the type of the output.
    template <class In, class Out, class N>
    static cudaError_t Sum(void* storage, std::size_t& bytes, In in, Out out, N n, cudaStream_t stream = nullptr) {
        using T = cuda_on_cpu::ValueOf<Out>;
        return Reduce(storage, bytes, in, out, n, cuda_on_cpu::Plus(), T{}, stream);
    }
    template <class In, class Out, class N>
    static cudaError_t Min(void* storage, std::size_t& bytes, In in, Out out, N n, cudaStream_t stream = nullptr) {
        using T = cuda_on_cpu::ValueOf<In>;
        return Reduce(
            storage, bytes, in, out, n, [](T a, T b) { return b < a ? b : a; }, std::numeric_limits<T>::max(), stream);
    }
    template <class In, class Out, class N>
    static cudaError_t Max(void* storage, std::size_t& bytes, In in, Out out, N n, cudaStream_t stream = nullptr) {
        using T = cuda_on_cpu::ValueOf<In>;
        return Reduce(
            storage, bytes, in, out, n, [](T a, T b) { return a < b ? b : a; }, std::numeric_limits<T>::lowest(),
            stream);
    }
    template <class In, class Out, class N, class Operation, class Initial>
    static cudaError_t Reduce(void* storage, std::size_t& bytes, In in, Out out, N n, Operation operation,
                              Initial initial, cudaStream_t stream = nullptr) {
        const std::size_t count = cuda_on_cpu::count_of(n);
        return cuda_on_cpu::device_primitive("DeviceReduce", storage, bytes, count / 64, stream, [=] {
            Initial result = initial;
            for (std::size_t i = 0; i < count; ++i) result = operation(result, static_cast<Initial>(in[i]));
            *out = static_cast<cuda_on_cpu::ValueOf<Out>>(result);
        });
    }
};

}  // namespace cub
