#pragma once

// Streams and events. Work that is given to a stream waits in its queue until somebody waits for it (settings.h,
// Progress); then the host's own thread does it, one piece at a time. Work is numbered as it is given: the legacy
// default stream and the blocking ones wait for each other's lower numbers, as CUDA promises.

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "cuda_on_cpu/machine/graph.h"

namespace cuda_on_cpu {

/// A place in a stream's queue, which an event names.
struct Marker {
    CUstream_st* stream = nullptr;
    std::uint64_t number = 0;
    bool reached = false;
    std::chrono::steady_clock::time_point at{};
};

}  // namespace cuda_on_cpu

struct CUstream_st {
    struct Item {
        std::uint64_t number;
        std::function<void()> run;
    };
    bool legacy = false, blocking = true;
    int priority = 0;
    int device = 0;
    std::deque<Item> queue;
    std::shared_ptr<cuda_on_cpu::Capture> capture;
    std::vector<std::size_t> tails;  ///< nodes of the capture that the next one comes after
};

struct CUevent_st {
    unsigned flags = 0;
    std::shared_ptr<cuda_on_cpu::Marker> marker;  ///< null: never recorded, which counts as reached
    std::weak_ptr<cuda_on_cpu::Capture> capture;  ///< the one it was recorded in
    bool captured = false;
    std::vector<std::size_t> tails;
};

namespace cuda_on_cpu {

/// Held by every call of the runtime: one host thread at a time drives the machine.
std::recursive_mutex& machine_mutex();

CUstream_st* create_stream(bool blocking, int priority, int device);
void destroy_stream(CUstream_st* stream);
/// The stream that a handle names: null and cudaStreamLegacy are the legacy stream, cudaStreamPerThread the calling
/// thread's own. Null if there is no such stream.
CUstream_st* stream_of(cudaStream_t handle);
CUevent_st* create_event(unsigned flags);
bool is_event(cudaEvent_t event);
void destroy_event(CUevent_st* event);

/// Gives a stream work: to its queue, or to the graph it captures.
cudaError_t enqueue(cudaStream_t handle, Work work);
/// The same for what has no place in a graph; refused during capture.
cudaError_t enqueue_uncaptured(cudaStream_t handle, std::function<void()> run);

/// True for the legacy stream while a blocking stream captures: it would wait for that one, so it cannot be used.
bool is_blocked(const CUstream_st* stream);

/// cudaSuccess if the host may wait, allocate, free or destroy a graph's executable now, in the mode of its thread or
/// in `mode`. If a capture forbids that, the capture is invalid from now on.
cudaError_t leave_capture_alone();
cudaError_t leave_capture_alone(cudaStreamCaptureMode mode);

/// Does all that waits in a stream, or up to and with a number.
void drain(CUstream_st* stream);
void drain(CUstream_st* stream, std::uint64_t number);
/// All streams, in the order of the settings.
void drain_all();
/// The first piece of work that waits, if any; so that a host that polls gets there.
void step(CUstream_st* stream);

cudaError_t record(CUevent_st* event, cudaStream_t handle);
cudaError_t wait_for(cudaStream_t handle, CUevent_st* event);
bool reached(const CUevent_st* event);

cudaError_t begin_capture(cudaStream_t handle, cudaStreamCaptureMode mode);
cudaError_t end_capture(cudaStream_t handle, Nodes& nodes);

}  // namespace cuda_on_cpu
