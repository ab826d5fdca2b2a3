#pragma once

// State that all queries of one cuda backend share.

#include <array>
#include <string>

#include "backends/cuda/device/captures.h"
#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/launch_queue.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/device_input.h"
#include "base/cancellation.h"
#include "crumple/options.h"

namespace crumple::cuda {

struct BackendState {
    BackendState(const Options& asked, MemoryMeter& m, Cancellation& c) : options(asked), meter(m), cancellation(c) {}

    /// Makes the backend's own stream wait for the work that the caller's stream has so far. Throws Error if the
    /// caller's stream is being captured, since waiting for it would invalidate the capture. `whose`: beginning of the
    /// message, for example "a mesh's".
    void follow(void* callers_stream, const char* whose) const {
        const auto callers = static_cast<cudaStream_t>(callers_stream);
        if (capture_of(callers) != 0)
            throw Error(ErrorCode::invalid_argument,
                        std::string(whose) + " stream is being captured; only launch() can be part of a capture");
        order(before, callers, stream.get());
    }

    const Options options;
    MemoryMeter& meter;
    Cancellation& cancellation;
    const Device device{options.device};
    const Geometry geometry = device.geometry();
    const Stream stream = make_stream(device);  ///< the backend's own stream
    const Event before = make_event(device);
    LaunchQueue launches_in_flight{device};
    /// Input of each slot. Launches take the two slots in turn, whatever their queries (device/launch_queue.h), so a
    /// slot belongs to one launch at a time.
    std::array<Input, LaunchQueue::slots> inputs{Input(device.index(), stream.get(), meter),
                                                 Input(device.index(), stream.get(), meter)};
};

}  // namespace crumple::cuda
