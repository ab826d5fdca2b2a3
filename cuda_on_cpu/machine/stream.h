#pragma once

// Streams and events. Work enqueued in a stream stays in its queue until somebody waits for it (settings.h, Progress);
// then the host's own thread does it, one item at a time. Items are numbered as they are enqueued: the legacy default
// stream and the blocking ones wait for each other's lower numbers, as CUDA promises.

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "cuda_on_cpu/machine/graph.h"

namespace cuda_on_cpu {

/// Position in a stream's queue, where an event was recorded.
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
    std::vector<std::size_t> tails;  ///< nodes of the capture on which the next one depends
};

struct CUevent_st {
    unsigned flags = 0;
    std::shared_ptr<cuda_on_cpu::Marker> marker;  ///< null: never recorded, which counts as reached
    std::weak_ptr<cuda_on_cpu::Capture> capture;  ///< capture in which it was recorded
    bool captured = false;
    std::vector<std::size_t> tails;
};

namespace cuda_on_cpu {

/// Returns the mutex that every call of the runtime holds: one host thread at a time drives the machine.
std::recursive_mutex& machine_mutex();

CUstream_st* create_stream(bool blocking, int priority, int device);
void destroy_stream(CUstream_st* stream);
/// Returns the stream that a handle names: null and cudaStreamLegacy name the legacy stream, cudaStreamPerThread the
/// calling thread's own. Returns null if there is no such stream.
CUstream_st* stream_of(cudaStream_t handle);
CUevent_st* create_event(unsigned flags);
bool is_event(cudaEvent_t event);
void destroy_event(CUevent_st* event);

/// Adds work to a stream's queue or, if it captures, to its graph.
cudaError_t enqueue(cudaStream_t handle, Work work);
/// Adds work that cannot be a node of a graph. During a capture it is refused, and invalidates the capture.
cudaError_t enqueue_uncaptured(cudaStream_t handle, std::function<void()> run);

/// True for the legacy stream while a blocking stream captures, unless that capture is in relaxed mode. The legacy
/// stream would wait for the blocking one, so it cannot be used.
bool is_blocked(const CUstream_st* stream);

/// Returns cudaSuccess if the host may wait, allocate, free or destroy a graph's executable now, in the mode of its
/// thread or in `mode`. Otherwise invalidates the captures that forbid it and returns an error.
cudaError_t leave_capture_alone();
cudaError_t leave_capture_alone(cudaStreamCaptureMode mode);

/// Does all pending work of a stream, or only the items up to and including the one with that number.
void drain(CUstream_st* stream);
void drain(CUstream_st* stream, std::uint64_t number);
/// Does all pending work of all streams, in the order of the settings.
void drain_all();
/// Does the first pending item of a stream, if any, so that a host that polls makes progress.
void step(CUstream_st* stream);

cudaError_t record(CUevent_st* event, cudaStream_t handle);
cudaError_t wait_for(cudaStream_t handle, CUevent_st* event);
bool reached(const CUevent_st* event);

cudaError_t begin_capture(cudaStream_t handle, cudaStreamCaptureMode mode);
cudaError_t end_capture(cudaStream_t handle, Nodes& nodes);

}  // namespace cuda_on_cpu
