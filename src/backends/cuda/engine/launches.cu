#include "backends/cuda/engine/launches.h"

#include "crumple/error.h"

namespace crumple::cuda {
namespace {

[[noreturn]] void refuse(const char* why) { throw Error(ErrorCode::invalid_argument, why); }

}  // namespace

LaunchNumber Launches::launch(Finder& finder, cudaStream_t stream, cudaStream_t other,
                              FunctionRef<void(std::size_t slot, Growth growth)> bind, bool of_worlds) {
    if (launches_in_flight_.full()) refuse("two launches are in flight; call wait() before the next launch");
    const auto bind_both = [&](std::size_t slot, Growth growth) {
        bind(slot, growth);
        if (other != stream) order(state_.before, other, stream);
    };
    const auto first = capture_of(stream), second = other == stream ? first : capture_of(other);
    if (first || second)
        return launch_in_capture(finder, of_worlds, first == second, stream,
                                 [&] { bind_both(finder.current(), Growth::fixed); });
    end_state();
    const std::size_t slot =
        finder.alone() && launches_in_flight_.count() == 0 ? launches_in_flight_.newest() : launches_in_flight_.next();
    bind_both(slot, Growth::grows);
    launches_in_flight_.queue(stream);
    finder.launch(stream);
    launches_in_flight_.add(slot, stream);
    return ++newest_;
}

// Does not allocate, free, copy or wait. Where one of these is necessary, bind() or capture() throws CapacityError,
// which becomes an Error.
LaunchNumber Launches::launch_in_capture(Finder& finder, bool of_worlds, bool same_capture, cudaStream_t stream,
                                         FunctionRef<void()> bind) {
    if (launches_in_flight_.count() > 0)
        refuse("launches are in flight; call wait() for them before a launch in a capture");
    if (capture_is_open()) refuse("a capture can have only one launch of a detector");
    phase_ = Phase::refused;
    reported_ = 0;
    if (!same_capture) refuse("the streams of both meshes must be in the same capture, or in none");
    try {
        bind();
        finder.capture(stream);
    } catch (const CapacityError&) {
        fail_unprepared_capture(of_worlds);
    }
    phase_ = Phase::captured;
    return ++newest_;
}

void Launches::check_awaited(LaunchNumber launch) const {
    if (phase_ == Phase::captured && launch == newest_) return;
    if (launch > oldest()) refuse("an older launch is in flight; call wait() in the order of the launches");
    if (launch == oldest()) return;
    if (launch == newest_ && launch == waited_) refuse("wait() has already been called for this launch");
    refuse("wait() is too late: another call of the detector came after this launch");
}

Launches::Outcome Launches::wait(Finder& finder, std::uint64_t revision) {
    if (phase_ == Phase::captured) return wait_for_replay(finder);
    end_state();
    waited_ = oldest();
    finder.resume(launches_in_flight_.complete_oldest());
    try {
        if (finder.accept_launched(revision)) return Outcome::complete;
    } catch (const MeshChanged&) {
    }
    return Outcome::lost;
}

// Requires that the caller has synchronized with the stream on which the graph was replayed.
Launches::Outcome Launches::wait_for_replay(Finder& finder) {
    refuse_open_capture();
    if (!finder.has_replayed()) refuse("wait() needs a replay of the captured launch before it");
    reported_ = 0;
    return finder.accept_replay() ? Outcome::complete : Outcome::incomplete;
}

bool Launches::capture_is_open() const {
    cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
    CRUMPLE_CUDA(cudaStreamIsCapturing(state_.stream.get(), &status));
    return status != cudaStreamCaptureStatusNone;
}

// While a capture is open, our streams take part in it, and so would any work that is enqueued on them.
void Launches::refuse_open_capture() const {
    if (capture_is_open()) refuse("a capture with a launch of this detector has not ended; end it before this call");
}

// Ends the state of a captured launch, and that of a reported result, which download() needs.
void Launches::end_state() {
    if (phase_ == Phase::captured) refuse_open_capture();
    phase_ = Phase::idle;
    reported_ = 0;
}

void Launches::finish() {
    end_state();
    launches_in_flight_.finish();
}

void Launches::forget() {
    phase_ = Phase::idle;
    reported_ = 0;
    launches_in_flight_.forget();
}

}  // namespace crumple::cuda
