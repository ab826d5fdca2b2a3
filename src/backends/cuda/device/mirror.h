#pragma once

// An array of the host's and its copy on the device. Frames of a simulation bring the same one again, and have no time
// to wait for a copy: so it is made only where the contents differ from those that lie there.

#include <algorithm>
#include <span>

#include "backends/cuda/device/memory.h"
#include "crumple/array.h"

namespace crumple::cuda {

template <class T>
class Mirror {
   public:
    explicit Mirror(MemoryMeter& meter) : block_(meter), there_(&meter) {}

    /// Where the device finds the array; the host's need not last. Throws NoRoom if that is fixed and another one lies
    /// there.
    const T* bring(cudaStream_t stream, std::span<const T> host, Room room = Room::grows) {
        const void* const before = block_.data();
        T* device = nullptr;
        lay_out(
            block_, [&](Cutter& c) { device = c.take<T>(host.size()); }, room);
        if (block_.data() == before && std::ranges::equal(there_, host)) return device;
        if (room == Room::fixed) throw NoRoom{};
        there_.clear();  // of a copy that fails nothing is known
        copy_now(stream, device, host.data(), host.size(), cudaMemcpyHostToDevice);
        std::ranges::copy(host, there_.resize_discard(host.size()));
        return device;
    }

    void release() {
        block_.release();
        there_.release();
    }

   private:
    Block block_;
    Array<T> there_;
};

}  // namespace crumple::cuda
