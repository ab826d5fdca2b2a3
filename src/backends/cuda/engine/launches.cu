#include "backends/cuda/engine/launches.h"

#include <string>

#include "crumple/error.h"

namespace crumple::cuda {
namespace {

const char* name_of(Asked question) {
    constexpr std::array<const char*, 5> names{"intersections", "intersections", "impacts", "proximities",
                                               "candidates"};
    return names[static_cast<std::size_t>(question)];
}
[[noreturn]] void refuse_wait(Asked question, const char* why) {
    throw Error(ErrorCode::invalid_argument, std::string("wait() for ") + name_of(question) + why);
}
void check_asked(Asked launched, Asked question) {
    if (launched != question)
        throw Error(ErrorCode::invalid_argument, std::string("the oldest launch is one of ") + name_of(launched));
}

}  // namespace

void Launches::launch(Finder& finder, Asked question, cudaStream_t stream, cudaStream_t other,
                      FunctionRef<void(std::size_t slot, Room room)> bind) {
    if (flights_.full())
        throw Error(ErrorCode::invalid_argument, "two launches are in flight: the next one comes after a wait()");
    const auto bind_both = [&](std::size_t slot, Room room) {
        bind(slot, room);
        if (other != stream) order(state_.before, other, stream);
    };
    const auto first = capture_of(stream), second = other == stream ? first : capture_of(other);
    if (first || second)
        return launch_in_capture(finder, question, first == second, stream,
                                 [&] { bind_both(finder.current(), Room::fixed); });
    end_state();
    const std::size_t slot = finder.alone() && flights_.count() == 0 ? flights_.newest() : flights_.next();
    bind_both(slot, Room::grows);
    flights_.queue(stream);
    finder.launch(stream);
    flights_.add(slot, stream);
    asked_[slot] = question;
}

// Nothing is allocated, freed, copied or waited for, and NoRoom is thrown where that does not do.
void Launches::launch_in_capture(Finder& finder, Asked question, bool same_capture, cudaStream_t stream,
                                 FunctionRef<void()> bind) {
    if (flights_.count() > 0)
        throw Error(ErrorCode::invalid_argument, "a launch in a capture comes after wait() for the one before");
    if (capture_is_open())
        throw Error(ErrorCode::invalid_argument, "a detector's launches in a capture are one at most");
    phase_ = Phase::refused;
    if (!same_capture)
        throw Error(ErrorCode::invalid_argument, "the streams of two meshes take part in one capture, or in none");
    try {
        bind();
        finder.capture(stream);
    } catch (const NoRoom&) {
        fail_unprepared_capture(question);
    }
    replayed_ = false;
    captured_ = question;
    phase_ = Phase::captured;
}

void Launches::check_awaited(Asked question) const {
    if (phase_ == Phase::captured) return check_asked(captured_, question);
    if (flights_.count() == 0) refuse_wait(question, " needs a launch before it");
    check_asked(asked_[flights_.oldest()], question);
}

Launches::Outcome Launches::wait(Finder& finder, Asked question, std::uint64_t revision) {
    if (phase_ == Phase::captured) return wait_for_replay(finder, question);
    end_state();
    finder.resume(flights_.land());
    try {
        if (finder.accept_launched(revision)) return Outcome::complete;
    } catch (const MeshChanged&) {
    }
    return Outcome::lost;
}

// The stream that it was on is done, says the caller.
Launches::Outcome Launches::wait_for_replay(Finder& finder, Asked question) {
    refuse_open_capture();
    if (!finder.has_replayed()) refuse_wait(question, " needs a replay of the captured launch before it");
    replayed_ = false;
    return finder.accept_replay() ? Outcome::complete : Outcome::incomplete;
}

bool Launches::awaits(Asked question) const {
    if (phase_ == Phase::captured) return captured_ == question;
    return flights_.count() > 0 && asked_[flights_.oldest()] == question;
}

void Launches::mark_reported(Asked question) {
    if (phase_ == Phase::captured) {
        replayed_ = true;
    } else {
        phase_ = Phase::reported;
        reported_ = question;
    }
}

bool Launches::has_reported(Asked question) const {
    if (phase_ == Phase::captured) return replayed_ && captured_ == question;
    return phase_ == Phase::reported && reported_ == question;
}

bool Launches::capture_is_open() const {
    cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
    CRUMPLE_CUDA(cudaStreamIsCapturing(state_.stream.get(), &status));
    return status != cudaStreamCaptureStatusNone;
}

// Streams of ours take part in a capture that is open, and what they are given now would, too.
void Launches::refuse_open_capture() const {
    if (capture_is_open())
        throw Error(ErrorCode::invalid_argument, "the capture that a launch was put into has not ended");
}

// A launch in a capture ends here, and so does download().
void Launches::end_state() {
    if (phase_ == Phase::captured) refuse_open_capture();
    phase_ = Phase::idle;
}

void Launches::finish() {
    end_state();
    flights_.finish();
}

void Launches::forget() {
    phase_ = Phase::idle;
    flights_.forget();
}

}  // namespace crumple::cuda
