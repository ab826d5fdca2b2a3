#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_device.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"

namespace cub {

/// Scans. Sums have the type of the input, as in CUB. Input and output may be the same.
struct DeviceScan {
    template <class In, class Out, class N>
    static cudaError_t ExclusiveSum(void* storage, std::size_t& bytes, In in, Out out, N n,
                                    cudaStream_t stream = nullptr) {
        using T = cuda_on_cpu::ValueOf<In>;
        return ExclusiveScan(storage, bytes, in, out, cuda_on_cpu::Plus(), T{}, n, stream);
    }
    template <class Data, class N>
    static cudaError_t ExclusiveSum(void* storage, std::size_t& bytes, Data data, N n, cudaStream_t stream = nullptr) {
        return ExclusiveSum(storage, bytes, data, data, n, stream);
    }
    template <class In, class Out, class N>
    static cudaError_t InclusiveSum(void* storage, std::size_t& bytes, In in, Out out, N n,
                                    cudaStream_t stream = nullptr) {
        return InclusiveScan(storage, bytes, in, out, cuda_on_cpu::Plus(), n, stream);
    }
    template <class Data, class N>
    static cudaError_t InclusiveSum(void* storage, std::size_t& bytes, Data data, N n, cudaStream_t stream = nullptr) {
        return InclusiveSum(storage, bytes, data, data, n, stream);
    }
    template <class In, class Out, class Operation, class Initial, class N>
    static cudaError_t ExclusiveScan(void* storage, std::size_t& bytes, In in, Out out, Operation operation,
                                     Initial initial, N n, cudaStream_t stream = nullptr) {
        const std::size_t count = cuda_on_cpu::count_of(n);
        return cuda_on_cpu::device_primitive("DeviceScan", storage, bytes, count / 64, stream, [=] {
            using T = std::remove_cvref_t<decltype(operation(initial, *in))>;
            T sum = initial;
            for (std::size_t i = 0; i < count; ++i) {
                const auto value = in[i];
                out[i] = static_cast<cuda_on_cpu::ValueOf<Out>>(sum);
                sum = operation(sum, static_cast<T>(value));
            }
        });
    }
    template <class In, class Out, class Operation, class N>
    static cudaError_t InclusiveScan(void* storage, std::size_t& bytes, In in, Out out, Operation operation, N n,
                                     cudaStream_t stream = nullptr) {
        const std::size_t count = cuda_on_cpu::count_of(n);
        return cuda_on_cpu::device_primitive("DeviceScan", storage, bytes, count / 64, stream, [=] {
            using T = std::remove_cvref_t<decltype(operation(*in, *in))>;
            T sum{};
            for (std::size_t i = 0; i < count; ++i) {
                const T value = in[i];
                sum = i ? operation(sum, value) : value;
                out[i] = static_cast<cuda_on_cpu::ValueOf<Out>>(sum);
            }
        });
    }
};

}  // namespace cub
