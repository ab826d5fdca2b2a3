#pragma once

// Launches whose answers nobody has asked for yet, oldest first. Each has one of two slots, in turn:
//
//     launch 1   launch 2   wait     launch 3   wait     ...
//     slot 0     slot 1     slot 0   slot 0     slot 1
//
// What a launch leaves for its wait() lies in its slot, so it stays until the second launch after it. All else is
// shared, so passes run one after the other, whatever streams they are on.

#include <array>
#include <cstddef>

#include "backends/cuda/device/cuda_device.h"

namespace crumple::cuda {

class Flights {
   public:
    static constexpr std::size_t slots = 2;

    explicit Flights(const Device& device) : done_{make_event(device), make_event(device)} {}

    std::size_t count() const { return count_; }
    bool full() const { return count_ == slots; }
    bool holds(std::size_t slot) const { return count_ == slots || (count_ == 1 && slot == newest_); }
    std::size_t newest() const { return newest_; }
    /// Of those in flight.
    std::size_t oldest() const { return count_ == slots ? next() : newest_; }
    /// The slot that was used longest ago; it is free unless all are in flight.
    std::size_t next() const { return (newest_ + 1) % slots; }

    /// Makes what the stream is given from now on wait for all passes in flight.
    void queue(cudaStream_t stream) const {
        if (count_ > 0) CRUMPLE_CUDA(cudaStreamWaitEvent(stream, done_[newest_].get(), 0));
    }
    /// The stream was given the pass of a slot that is free.
    void add(std::size_t slot, cudaStream_t stream) {
        CRUMPLE_CUDA(cudaEventRecord(done_[slot].get(), stream));
        newest_ = slot;
        ++count_;
    }
    /// Takes the oldest out, of one at least, waits for it, and returns its slot.
    std::size_t land() {
        const std::size_t landed = oldest();
        --count_;
        CRUMPLE_CUDA(cudaEventSynchronize(done_[landed].get()));
        return landed;
    }
    /// Waits for all passes; they stay in flight.
    void settle() const {
        if (count_ > 0) CRUMPLE_CUDA(cudaEventSynchronize(done_[newest_].get()));
    }
    /// Forgets those in flight, once they are over or because the device has failed.
    void finish() {
        settle();
        forget();
    }
    void forget() { count_ = 0; }

   private:
    std::array<Event, slots> done_;
    std::size_t newest_ = slots - 1, count_ = 0;
};

}  // namespace crumple::cuda
