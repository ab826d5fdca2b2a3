#pragma once

// Common part of the counterparts of CUB's device-wide primitives: two phases, and temporary storage all of which is
// overwritten. The host's thread does their work, in the order of the stream or as a node of a graph.

#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>

#include "cuda_on_cpu/machine/launch.h"
#include "cuda_on_cpu/machine/memory.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu {

template <class F>
inline constexpr char function_of = 0;

/// First phase (`storage` null): sets `bytes` to the size needed, which is never 0. Second phase: checks the storage,
/// and enqueues work that fills all of it with rubbish and calls run().
template <class F>
cudaError_t device_primitive(const char* name, void* storage, std::size_t& bytes, std::size_t data_bytes,
                             cudaStream_t stream, F run) {
    const std::size_t needed = data_bytes + 767;
    if (!storage) {
        bytes = needed;
        return cudaSuccess;
    }
    if (bytes < needed) return cudaErrorInvalidValue;
    if (!memory::covers(storage, needed))
        fail("%s: its temporary storage of %zu bytes does not lie in one allocation", name, needed);
    return enqueue_device_work(stream, &function_of<F>, [=] {
        host_random().fill(storage, needed);
        run();
    });
}

template <class Iterator>
using ValueOf = std::remove_cvref_t<decltype(*std::declval<Iterator&>())>;

template <class Integer>
constexpr std::size_t count_of(Integer n) {
    return static_cast<std::size_t>(n);
}

}  // namespace cuda_on_cpu
