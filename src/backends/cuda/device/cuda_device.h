#pragma once

// The device that a backend works on, and the handles that live there.

#include <type_traits>

#include "backends/cuda/device/runtime.h"
#include "crumple/error.h"
#include "crumple/intersections.h"

namespace crumple::cuda {

class Device {
   public:
    /// Throws Error (backend_unavailable) if there is no such device, with the reason.
    explicit Device(int index);

    /// Threads of a block, and how many blocks keep the device busy.
    Geometry geometry() const;

    /// Makes the device this thread's current one while it lives, and has it leave other threads' captures alone.
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

/// Threads of a block, for devices made from now on; for tests: 64 or 256.
extern unsigned block_threads;

/// Runs work() with the device as this thread's. A device that has no memory left is an Error (device).
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
/// Without times.
Event make_event(const Device& device);

/// Makes what `then` is given from now on wait for what `first` was given.
void order(const Event& event, cudaStream_t first, cudaStream_t then);

/// A second stream, whose work begins where another stream is and ends where that one waits for it: what lies between
/// runs beside. In a capture it is a branch of the graph.
class Branch {
   public:
    explicit Branch(const Device& device) : stream_(make_stream(device)), turn_(make_event(device)) {}
    cudaStream_t fork(cudaStream_t from) const {
        order(turn_, from, stream_.get());
        return stream_.get();
    }
    void join(cudaStream_t into) const { order(turn_, stream_.get(), into); }
    cudaStream_t stream() const { return stream_.get(); }

   private:
    Stream stream_;
    Event turn_;
};

/// Times of the stages: an event at the start of each.
class StageEvents {
   public:
    explicit StageEvents(const Device& device);
    void begin(Stage stage, cudaStream_t stream);
    void end(cudaStream_t stream);
    /// After the stream was synchronised.
    void read(Statistics& statistics) const;

   private:
    Event events_[stage_count + 1];
};

}  // namespace crumple::cuda
