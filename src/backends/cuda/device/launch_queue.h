#pragma once

// Launches in flight, whose results have not been waited for yet, oldest first. Launches take two slots in turn:
//
//     launch 1   launch 2   wait     launch 3   wait     ...
//     slot 0     slot 1     slot 0   slot 0     slot 1
//
// A slot holds the data that a launch leaves for its wait(), so they remain valid until the second launch after it. All
// other data are shared, so passes run one after the other, on whatever streams.

#include <array>
#include <cstddef>

#include "backends/cuda/device/cuda_device.h"

namespace crumple::cuda {

class LaunchQueue {
   public:
    static constexpr std::size_t slots = 2;

    explicit LaunchQueue(const Device& device) : done_{make_event(device), make_event(device)} {}

    std::size_t count() const { return count_; }
    bool full() const { return count_ == slots; }
    bool holds(std::size_t slot) const { return count_ == slots || (count_ == 1 && slot == newest_); }
    std::size_t newest() const { return newest_; }
    /// Returns the slot of the oldest launch; there must be one.
    std::size_t oldest() const { return count_ == slots ? next() : newest_; }
    /// Returns the least recently used slot. It is free unless all are in flight.
    std::size_t next() const { return (newest_ + 1) % slots; }

    /// Makes work that is enqueued on the stream from now on wait for all passes in flight.
    void queue(cudaStream_t stream) const {
        if (count_ > 0) CRUMPLE_CUDA(cudaStreamWaitEvent(stream, done_[newest_].get(), 0));
    }
    /// Records that the pass of a free slot has been enqueued on the stream.
    void add(std::size_t slot, cudaStream_t stream) {
        CRUMPLE_CUDA(cudaEventRecord(done_[slot].get(), stream));
        newest_ = slot;
        ++count_;
    }
    /// Removes the oldest launch, of which there must be one, waits for its pass, and returns its slot.
    std::size_t complete_oldest() {
        const std::size_t finished = oldest();
        --count_;
        CRUMPLE_CUDA(cudaEventSynchronize(done_[finished].get()));
        return finished;
    }
    /// Synchronizes with all passes; they stay in flight.
    void synchronize() const {
        if (count_ > 0) CRUMPLE_CUDA(cudaEventSynchronize(done_[newest_].get()));
    }
    /// Waits for the passes in flight, and drops their launches.
    void finish() {
        synchronize();
        forget();
    }
    /// Drops the launches in flight without waiting, for a device that has failed.
    void forget() { count_ = 0; }

   private:
    std::array<Event, slots> done_;
    std::size_t newest_ = slots - 1, count_ = 0;
};

}  // namespace crumple::cuda
