#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_device.h"

namespace cub {

struct DeviceRunLengthEncode {
    /// Writes the item and the length of each run, and the number of runs.
    template <class In, class Items, class Lengths, class Count, class N>
    static cudaError_t Encode(void* storage, std::size_t& bytes, In in, Items items, Lengths lengths, Count runs, N n,
                              cudaStream_t stream = nullptr) {
        return encode(storage, bytes, in, runs, n, stream, [=](std::size_t run, std::size_t at, std::size_t length) {
            items[run] = in[at];
            lengths[run] = static_cast<cuda_on_cpu::ValueOf<Lengths>>(length);
            return true;
        });
    }
    /// Writes the offset and the length of each run of two or more items, and their number.
    template <class In, class Offsets, class Lengths, class Count, class N>
    static cudaError_t NonTrivialRuns(void* storage, std::size_t& bytes, In in, Offsets offsets, Lengths lengths,
                                      Count runs, N n, cudaStream_t stream = nullptr) {
        return encode(storage, bytes, in, runs, n, stream, [=](std::size_t run, std::size_t at, std::size_t length) {
            if (length < 2) return false;
            offsets[run] = static_cast<cuda_on_cpu::ValueOf<Offsets>>(at);
            lengths[run] = static_cast<cuda_on_cpu::ValueOf<Lengths>>(length);
            return true;
        });
    }

   private:
    /// Calls write(run, begin, length), which returns true if the run counts, for each run.
    template <class In, class Count, class N, class Write>
    static cudaError_t encode(void* storage, std::size_t& bytes, In in, Count runs, N n, cudaStream_t stream,
                              Write write) {
        const std::size_t count = cuda_on_cpu::count_of(n);
        return cuda_on_cpu::device_primitive("DeviceRunLengthEncode", storage, bytes, count / 64, stream, [=] {
            std::size_t found = 0;
            for (std::size_t begin = 0, end; begin < count; begin = end) {
                for (end = begin + 1; end < count && in[end] == in[begin];) ++end;
                if (write(found, begin, end - begin)) ++found;
            }
            *runs = static_cast<cuda_on_cpu::ValueOf<Count>>(found);
        });
    }
};

}  // namespace cub
