#pragma once

// Device copy of a host array, uploaded only if the contents have changed: frames of a simulation mostly pass the same
// contents, and should not wait for a copy.

#include <algorithm>
#include <span>

#include "backends/cuda/device/memory.h"
#include "crumple/array.h"

namespace crumple::cuda {

template <class T>
class Mirror {
   public:
    explicit Mirror(MemoryMeter& meter) : block_(meter), uploaded_(&meter) {}

    /// Returns the device's copy of `host`, which need not outlive the call. Throws CapacityError if an upload is
    /// needed, but `growth` is fixed.
    const T* bring(cudaStream_t stream, std::span<const T> host, Growth growth = Growth::grows) {
        const void* const before = block_.data();
        T* device = nullptr;
        place_arrays(
            block_, [&](ArenaLayout& c) { device = c.take<T>(host.size()); }, growth);
        if (block_.data() == before && std::ranges::equal(uploaded_, host)) return device;
        if (growth == Growth::fixed) throw CapacityError{};
        uploaded_.clear();  // if the copy fails, the contents are unknown
        copy_now(stream, device, host.data(), host.size(), cudaMemcpyHostToDevice);
        std::ranges::copy(host, uploaded_.resize_discard(host.size()));
        return device;
    }

    void release() {
        block_.release();
        uploaded_.release();
    }

   private:
    Block block_;
    Array<T> uploaded_;
};

}  // namespace crumple::cuda
