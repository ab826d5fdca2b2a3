#pragma once

// Device of a backend, and owners of its streams and events.

#include <type_traits>

#include "backends/cuda/device/runtime.h"
#include "crumple/error.h"
#include "crumple/intersections.h"

namespace crumple::cuda {

class Device {
   public:
    /// Throws Error (backend_unavailable), with the reason, if there is no such device or this build cannot use it.
    explicit Device(int index);

    /// Returns the threads per block, and the number of blocks that keep the device busy.
    Geometry geometry() const;

    /// Makes the device this thread's current one for the object's lifetime, in relaxed capture mode, which leaves
    /// other threads' captures alone.
    class Current {
       public:
        explicit Current(const Device& device);
        ~Current();
        Current(const Current&) = delete;
        Current& operator=(const Current&) = delete;

       private:
        CaptureMode relaxed_{cudaStreamCaptureModeRelaxed};
        int before_ = 0;
        bool switched_ = false;
    };

    int index() const { return index_; }

   private:
    int index_;
};

/// Threads per block that Device::geometry() returns: 64 or 256. Only tests change it.
extern unsigned block_threads;

/// Runs work() with the device as this thread's current one. Turns OutOfDeviceMemory into Error (device).
template <class Work>
std::invoke_result_t<Work> with_device(const Device& device, Work work) {
    const Device::Current current(device);
    try {
        return work();
    } catch (const OutOfDeviceMemory& error) {
        throw Error(ErrorCode::device, error.message());
    }
}

Stream make_stream(const Device& device);
/// Makes an event without timing.
Event make_event(const Device& device);

/// Makes work that is enqueued on `then` from now on wait for the work that `first` has so far.
void order(const Event& event, cudaStream_t first, cudaStream_t then);

/// Second stream, which forks from another stream and joins it later. Work in between runs in parallel; in a capture it
/// is a branch of the graph.
class Branch {
   public:
    explicit Branch(const Device& device) : stream_(make_stream(device)), ordering_event_(make_event(device)) {}
    cudaStream_t fork(cudaStream_t from) const {
        order(ordering_event_, from, stream_.get());
        return stream_.get();
    }
    void join(cudaStream_t into) const { order(ordering_event_, stream_.get(), into); }
    cudaStream_t stream() const { return stream_.get(); }

   private:
    Stream stream_;
    Event ordering_event_;
};

/// Timing of the stages, by an event at the start of each and one at the end.
class StageEvents {
   public:
    explicit StageEvents(const Device& device);
    void begin(Stage stage, cudaStream_t stream);
    void end(cudaStream_t stream);
    /// Adds the times to the statistics. The stream must have been synchronized.
    void read(Statistics& statistics) const;

   private:
    Event events_[stage_count + 1];
};

}  // namespace crumple::cuda
