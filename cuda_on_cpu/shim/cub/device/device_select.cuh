#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_device.h"

namespace cub {

/// Selects items in their order, and writes their number to *selected.
struct DeviceSelect {
    template <class In, class Flags, class Out, class Count, class N>
    static cudaError_t Flagged(void* storage, std::size_t& bytes, In in, Flags flags, Out out, Count selected, N n,
                               cudaStream_t stream = nullptr) {
        return select(storage, bytes, in, out, selected, n, stream,
                      [flags](std::size_t i) { return static_cast<bool>(flags[i]); });
    }
    template <class Data, class Flags, class Count, class N>
    static cudaError_t Flagged(void* storage, std::size_t& bytes, Data data, Flags flags, Count selected, N n,
                               cudaStream_t stream = nullptr) {
        return Flagged(storage, bytes, data, flags, data, selected, n, stream);
    }
    template <class In, class Out, class Count, class N, class Predicate>
    static cudaError_t If(void* storage, std::size_t& bytes, In in, Out out, Count selected, N n, Predicate predicate,
                          cudaStream_t stream = nullptr) {
        return select(storage, bytes, in, out, selected, n, stream,
                      [in, predicate](std::size_t i) { return static_cast<bool>(predicate(in[i])); });
    }
    template <class Data, class Count, class N, class Predicate>
    static cudaError_t If(void* storage, std::size_t& bytes, Data data, Count selected, N n, Predicate predicate,
                          cudaStream_t stream = nullptr) {
        return If(storage, bytes, data, data, selected, n, predicate, stream);
    }
    /// Selects the first of each run of equal items.
    template <class In, class Out, class Count, class N>
    static cudaError_t Unique(void* storage, std::size_t& bytes, In in, Out out, Count selected, N n,
                              cudaStream_t stream = nullptr) {
        return select(storage, bytes, in, out, selected, n, stream,
                      [in](std::size_t i) { return i == 0 || !(in[i] == in[i - 1]); });
    }

   private:
    template <class In, class Out, class Count, class N, class Wanted>
    static cudaError_t select(void* storage, std::size_t& bytes, In in, Out out, Count selected, N n,
                              cudaStream_t stream, Wanted wanted) {
        const std::size_t count = cuda_on_cpu::count_of(n);
        return cuda_on_cpu::device_primitive("DeviceSelect", storage, bytes, count / 64, stream, [=] {
            std::size_t found = 0;
            for (std::size_t i = 0; i < count; ++i)
                if (wanted(i)) out[found++] = in[i];
            *selected = static_cast<cuda_on_cpu::ValueOf<Count>>(found);
        });
    }
};

}  // namespace cub
