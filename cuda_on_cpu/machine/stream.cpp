#include "cuda_on_cpu/machine/stream.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "cuda_on_cpu/machine/call.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu {
namespace {

struct State {
    CUstream_st legacy;
    std::vector<std::unique_ptr<CUstream_st>> streams;  // in order of creation
    std::set<CUevent_st*> events;
    std::vector<std::weak_ptr<Capture>> captures;
    std::uint64_t number = 0;
    unsigned long long captured = 0;  // number of captures so far
    State() { legacy.legacy = true; }
    ~State() {
        for (CUevent_st* event : events) delete event;
    }
};

State& state() {
    static State instance;
    return instance;
}

/// Calls f(stream) for each blocking stream: the legacy stream and these wait for each other.
template <class F>
void for_each_blocking(F f) {
    for (const auto& stream : state().streams)
        if (stream->blocking) f(*stream);
}

void run_first(CUstream_st* stream) {
    const std::uint64_t number = stream->queue.front().number;
    if (stream->legacy)
        for_each_blocking([&](CUstream_st& other) { drain(&other, number); });
    else if (stream->blocking)
        drain(&state().legacy, number);
    // Draining another stream may have run this item, too.
    if (stream->queue.empty() || stream->queue.front().number != number) return;
    const CUstream_st::Item item = std::move(stream->queue.front());
    stream->queue.pop_front();
    item.run();
}

void push(CUstream_st* stream, std::function<void()> run) {
    State& s = state();
    stream->queue.push_back({++s.number, std::move(run)});
    switch (settings().progress) {
        case Progress::lazy:
            break;
        case Progress::eager:
            drain(stream);
            break;
        case Progress::random:
            while (host_random().below(3) == 0) {
                const auto chosen = host_random().below(s.streams.size() + 1);
                step(chosen == s.streams.size() ? &s.legacy : s.streams[chosen].get());
            }
            break;
    }
}

bool forbids_legacy(const CUstream_st& blocking) {
    return blocking.capture && blocking.capture->mode != cudaStreamCaptureModeRelaxed;
}

/// If captures make the stream unusable (is_blocked), invalidates these captures and returns true.
bool legacy_meets_capture(const CUstream_st* stream) {
    if (!is_blocked(stream)) return false;
    for_each_blocking([](CUstream_st& other) {
        if (forbids_legacy(other)) other.capture->invalid = true;
    });
    return true;
}

void add(std::vector<std::size_t>& tails, const std::vector<std::size_t>& more) {
    std::vector<std::size_t> both;
    std::set_union(tails.begin(), tails.end(), more.begin(), more.end(), std::back_inserter(both));
    tails = std::move(both);
}

}  // namespace

std::recursive_mutex& machine_mutex() {
    static std::recursive_mutex mutex;
    return mutex;
}

CUstream_st* create_stream(bool blocking, int priority, int device) {
    auto stream = std::make_unique<CUstream_st>();
    stream->blocking = blocking;
    stream->priority = priority;
    stream->device = device;
    state().streams.push_back(std::move(stream));
    return state().streams.back().get();
}

void destroy_stream(CUstream_st* stream) {
    drain(stream);
    if (stream->capture) {
        stream->capture->invalid = true;
        stream->capture->members.erase(stream);
    }
    auto& all = state().streams;
    all.erase(std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.get() == stream; }));
}

CUstream_st* stream_of(cudaStream_t handle) {
    if (!handle || handle == cudaStreamLegacy) return &state().legacy;
    if (handle == cudaStreamPerThread) {
        thread_local CUstream_st* const own = create_stream(true, 0, 0);
        return own;
    }
    for (const auto& stream : state().streams)
        if (stream.get() == handle) return handle;
    return nullptr;
}

CUevent_st* create_event(unsigned flags) {
    auto* event = new CUevent_st;
    event->flags = flags;
    state().events.insert(event);
    return event;
}

bool is_event(cudaEvent_t event) { return state().events.count(event) != 0; }

void destroy_event(CUevent_st* event) {
    state().events.erase(event);
    delete event;
}

cudaError_t enqueue(cudaStream_t handle, Work work) {
    CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    if (legacy_meets_capture(stream)) return cudaErrorStreamCaptureImplicit;
    if (!stream->capture) {
        push(stream, std::move(work.run));
        return cudaSuccess;
    }
    Capture& capture = *stream->capture;
    if (capture.invalid) return cudaErrorStreamCaptureInvalidated;
    capture.nodes.push_back({std::move(work), stream->tails});
    stream->tails = {capture.nodes.size() - 1};
    return cudaSuccess;
}

cudaError_t enqueue_uncaptured(cudaStream_t handle, std::function<void()> run) {
    CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    if (legacy_meets_capture(stream)) return cudaErrorStreamCaptureImplicit;
    if (stream->capture) {
        stream->capture->invalid = true;
        return cudaErrorStreamCaptureUnsupported;
    }
    push(stream, std::move(run));
    return cudaSuccess;
}

bool is_blocked(const CUstream_st* stream) {
    bool blocked = false;
    if (stream->legacy) for_each_blocking([&](const CUstream_st& other) { blocked |= forbids_legacy(other); });
    return blocked;
}

cudaError_t leave_capture_alone() { return leave_capture_alone(host_thread().capture_mode); }
cudaError_t leave_capture_alone(cudaStreamCaptureMode mode) {
    cudaError_t result = cudaSuccess;
    if (mode == cudaStreamCaptureModeRelaxed) return result;
    for (const auto& weak : state().captures) {
        const auto capture = weak.lock();
        if (!capture) continue;
        const bool own = capture->thread == std::this_thread::get_id();
        const bool forbids = own ? capture->mode != cudaStreamCaptureModeRelaxed
                                 : mode == cudaStreamCaptureModeGlobal && capture->mode == cudaStreamCaptureModeGlobal;
        if (!forbids) continue;
        capture->invalid = true;
        result = cudaErrorStreamCaptureUnsupported;
    }
    return result;
}

void drain(CUstream_st* stream, std::uint64_t number) {
    while (!stream->queue.empty() && stream->queue.front().number <= number) run_first(stream);
}

void drain(CUstream_st* stream) { drain(stream, state().number); }

void drain_all() {
    State& s = state();
    std::vector<CUstream_st*> busy;
    const auto collect = [&] {
        busy.clear();
        for (const auto& stream : s.streams)
            if (!stream->queue.empty()) busy.push_back(stream.get());
        if (!s.legacy.queue.empty()) busy.push_back(&s.legacy);
        return !busy.empty();
    };
    while (collect()) switch (settings().order) {
            case Order::forward:
                drain(busy.front());
                break;
            case Order::reverse:
                drain(busy.back());
                break;
            case Order::random:
                step(busy[host_random().below(busy.size())]);
                break;
        }
}

void step(CUstream_st* stream) {
    if (!stream->queue.empty()) run_first(stream);
}

cudaError_t record(CUevent_st* event, cudaStream_t handle) {
    CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    if (legacy_meets_capture(stream)) return cudaErrorStreamCaptureImplicit;
    if (stream->capture) {
        if (stream->capture->invalid) return cudaErrorStreamCaptureInvalidated;
        event->captured = true;
        event->capture = stream->capture;
        event->tails = stream->tails;
        return cudaSuccess;
    }
    event->captured = false;
    const auto marker = std::make_shared<Marker>();
    marker->stream = stream;
    marker->number = state().number + 1;
    event->marker = marker;
    push(stream, [marker] {
        marker->reached = true;
        marker->at = std::chrono::steady_clock::now();
    });
    return cudaSuccess;
}

cudaError_t wait_for(cudaStream_t handle, CUevent_st* event) {
    CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    if (legacy_meets_capture(stream)) return cudaErrorStreamCaptureImplicit;
    if (event->captured) {
        const auto capture = event->capture.lock();
        if (!capture) return cudaErrorCapturedEvent;
        if (stream->legacy) return cudaErrorStreamCaptureImplicit;
        if (stream->capture && stream->capture != capture) {
            capture->invalid = stream->capture->invalid = true;
            return cudaErrorStreamCaptureMerge;
        }
        if (!stream->capture) {
            stream->capture = capture;
            stream->tails.clear();
            capture->members.insert(stream);
        }
        add(stream->tails, event->tails);
        return cudaSuccess;
    }
    if (stream->capture) {
        stream->capture->invalid = true;
        return cudaErrorStreamCaptureIsolation;
    }
    if (!event->marker || event->marker->reached) return cudaSuccess;
    push(stream, [marker = event->marker] {
        if (!marker->reached) drain(marker->stream, marker->number);
    });
    return cudaSuccess;
}

bool reached(const CUevent_st* event) { return !event->marker || event->marker->reached; }

cudaError_t begin_capture(cudaStream_t handle, cudaStreamCaptureMode mode) {
    CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    if (stream->legacy) return cudaErrorStreamCaptureUnsupported;
    if (stream->capture) return cudaErrorIllegalState;
    auto capture = std::make_shared<Capture>();
    capture->origin = stream;
    capture->mode = mode;
    capture->thread = std::this_thread::get_id();
    capture->id = ++state().captured;
    capture->members = {stream};
    stream->tails.clear();
    auto& captures = state().captures;
    captures.erase(std::remove_if(captures.begin(), captures.end(), [](const auto& c) { return c.expired(); }),
                   captures.end());
    captures.push_back(capture);
    stream->capture = std::move(capture);
    return cudaSuccess;
}

cudaError_t end_capture(cudaStream_t handle, Nodes& nodes) {
    CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    const std::shared_ptr<Capture> capture = stream->capture;
    if (!capture) return cudaErrorIllegalState;
    if (capture->origin != stream) return cudaErrorStreamCaptureUnmatched;
    if (capture->mode != cudaStreamCaptureModeRelaxed && capture->thread != std::this_thread::get_id())
        return cudaErrorStreamCaptureWrongThread;
    // The origin's last nodes must depend on all nodes of other streams.
    std::vector<bool> joined(capture->nodes.size(), false);
    for (const std::size_t tail : stream->tails) joined[tail] = true;
    for (std::size_t i = joined.size(); i-- > 0;)
        if (joined[i])
            for (const std::size_t before : capture->nodes[i].after) joined[before] = true;
    for (CUstream_st* member : capture->members) {
        member->capture.reset();
        member->tails.clear();
    }
    if (capture->invalid) return cudaErrorStreamCaptureInvalidated;
    if (std::find(joined.begin(), joined.end(), false) != joined.end()) return cudaErrorStreamCaptureUnjoined;
    nodes = std::move(capture->nodes);
    return cudaSuccess;
}

}  // namespace cuda_on_cpu
