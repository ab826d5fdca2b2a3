#pragma once

// Whose turn it is: launches whose answers nobody has asked for, what each of them asks, and whether a pass is in a
// caller's graph. Calls that are no launches end all that.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "backends/cuda/device/captures.h"
#include "backends/cuda/device/flights.h"
#include "backends/cuda/device/memory.h"
#include "backends/device_feature_calls.h"
#include "crumple/error.h"

namespace crumple::cuda {

inline const char* name_of(Asked question) {
    constexpr std::array<const char*, 5> names{"intersections", "intersections", "impacts", "proximities",
                                               "candidates"};
    return names[static_cast<std::size_t>(question)];
}

class Turns {
   public:
    Turns(const Device& device, cudaStream_t own) : flights(device), own_(own) {}

    Flights flights;

    enum class State : std::uint8_t {
        idle,
        answered,  ///< by a wait, and no call came after that
        captured,  ///< a pass is in a caller's graph, and its memory stays
        refused,   ///< a launch in a capture, which nothing may be freed in
    };
    State state = State::idle;

    /// Gives `stream` a pass: prepare(slot) has its arrays brought, start() launches it. `alone`: one slot is to do.
    template <class Prepare, class Start>
    void launch(Asked question, cudaStream_t stream, bool alone, Prepare prepare, Start start) {
        end_state();
        const std::size_t slot = alone && flights.count() == 0 ? flights.newest() : flights.next();
        prepare(slot);
        flights.queue(stream);
        start();
        flights.add(slot, stream);
        asked_[slot] = question;
    }
    void refuse_third() const {
        if (flights.full())
            throw Error(ErrorCode::invalid_argument, "two launches are in flight: the next one comes after a wait()");
    }

    /// The same in a caller's capture: nothing is allocated, freed, copied or waited for. capture() throws NoRoom where
    /// that does not do.
    template <class Capture>
    void launch_in_capture(Asked question, bool same_capture, Capture capture) {
        if (flights.count() > 0)
            throw Error(ErrorCode::invalid_argument, "a launch in a capture comes after wait() for the one before");
        if (capture_is_open())
            throw Error(ErrorCode::invalid_argument, "a detector's launches in a capture are one at most");
        state = State::refused;
        if (!same_capture)
            throw Error(ErrorCode::invalid_argument, "the streams of two meshes take part in one capture, or in none");
        try {
            capture();
        } catch (const NoRoom&) {
            fail_unprepared_capture(question);
        }
        replayed = false;
        captured_ = question;
        state = State::captured;
    }
    /// Whether a replay is what is waited for; `question`: who asks.
    bool waits_for_replay(Asked question) const {
        if (state != State::captured) return false;
        check(captured_, question);
        return true;
    }
    bool replayed = false;  ///< since the capture: a wait has told of it
    /// Before a wait looks at what a replay has left.
    void begin_replay(Asked question, bool has_replayed) {
        refuse_open_capture();
        if (!has_replayed) refuse(question, " needs a replay of the captured launch before it");
        replayed = false;
    }

    /// A wait has told of the launch that asked that, and no call has come after it.
    void answer(Asked question) {
        state = State::answered;
        answered_ = question;
    }
    bool has_answered(Asked question) const {
        if (state == State::captured) return replayed && captured_ == question;
        return state == State::answered && answered_ == question;
    }

    /// True if what is waited for, a replay or the oldest launch in flight, asks that.
    bool awaits(Asked question) const {
        if (state == State::captured) return captured_ == question;
        return flights.count() > 0 && asked_[flights.oldest()] == question;
    }

    /// Throws Error unless the oldest launch in flight asks that.
    void refuse_other(Asked question) const {
        if (flights.count() == 0) refuse(question, " needs a launch before it");
        check(asked_[flights.oldest()], question);
    }

    /// Streams of ours take part in a capture that is open, and what they are given now would, too.
    void refuse_open_capture() const {
        if (capture_is_open())
            throw Error(ErrorCode::invalid_argument, "the capture that a launch was put into has not ended");
    }
    /// A launch in a capture ends here, and so does download().
    void end_state() {
        if (state == State::captured) refuse_open_capture();
        state = State::idle;
    }
    /// Launches that nobody waited for are over before their memory is used again.
    void finish() {
        end_state();
        flights.finish();
    }

   private:
    bool capture_is_open() const {
        cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
        CRUMPLE_CUDA(cudaStreamIsCapturing(own_, &status));
        return status != cudaStreamCaptureStatusNone;
    }
    [[noreturn]] static void refuse(Asked question, const char* why) {
        throw Error(ErrorCode::invalid_argument, std::string("wait() for ") + name_of(question) + why);
    }
    static void check(Asked launched, Asked question) {
        if (launched != question)
            throw Error(ErrorCode::invalid_argument, std::string("the oldest launch is one of ") + name_of(launched));
    }

    cudaStream_t own_;
    std::array<Asked, Flights::slots> asked_{};  ///< by slot
    Asked captured_{}, answered_{};
};

}  // namespace crumple::cuda
