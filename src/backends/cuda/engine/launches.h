#pragma once

// State of launches and waits of all queries: which launches are in flight, and whether a caller's graph holds a pass.
// Any other call of the backend ends this state: it drops the launches, and makes the graph stale.

#include <cstddef>
#include <cstdint>

#include "backends/cuda/engine/finder.h"
#include "backends/device_feature_calls.h"

namespace crumple::cuda {

static_assert(LaunchQueue::slots == most_in_flight);

class Launches {
   public:
    explicit Launches(BackendState& state) : state_(state), launches_in_flight_(state.launches_in_flight) {}

    /// Enqueues a pass on `stream`, or adds it to the capture that the stream takes part in. bind(slot, growth) makes
    /// the finder work on a slot and binds the inputs, which are ready once the work that `stream` and `other` have so
    /// far is complete. `other`: the second mesh's stream, or `stream` again. `of_worlds`: true for a launch on worlds;
    /// selects the text of the error about a capture without the calls that have to precede it.
    LaunchNumber launch(Finder& finder, cudaStream_t stream, cudaStream_t other,
                        FunctionRef<void(std::size_t slot, Growth growth)> bind, bool of_worlds = false);

    enum class Outcome : std::uint8_t {
        complete,    ///< the finder has the result
        incomplete,  ///< the last replay has left only a part of the result
        lost,        ///< the result has to be found again
    };
    /// Throws Error unless this is the oldest launch in flight, or the one in a caller's graph, which replays repeat.
    void check_awaited(LaunchNumber launch) const;
    /// To be called after check_awaited() with the finder of that launch. Waits for the launch, or reads the result of
    /// its last replay. `revision`: that of the current features; a launch for other features is lost.
    Outcome wait(Finder& finder, std::uint64_t revision = 0);

    /// Records that a wait has returned the result of this launch, as download() requires. The next call clears the
    /// record.
    void mark_reported(LaunchNumber launch) { reported_ = launch; }
    bool has_reported(LaunchNumber launch) const { return reported_ == launch; }

    /// Waits for launches in flight and drops them, before their memory is used again.
    void finish();
    /// Drops launches in flight without waiting, if the device has failed.
    void forget();
    /// True if a caller's graph or a launch in flight needs the memory of this backend.
    bool needs_memory() const { return phase_ == Phase::captured || launches_in_flight_.count() > 0; }
    /// True if the last call was a launch in a capture, during which nothing may be freed, and was refused.
    bool was_refused() const { return phase_ == Phase::refused; }

   private:
    enum class Phase : std::uint8_t {
        idle,
        captured,  ///< a caller's graph holds a pass, whose memory must stay
        refused,   ///< a launch in a capture, during which nothing may be freed, was refused
    };

    LaunchNumber launch_in_capture(Finder& finder, bool of_worlds, bool same_capture, cudaStream_t stream,
                                   FunctionRef<void()> bind);
    Outcome wait_for_replay(Finder& finder);
    /// Returns the oldest launch in flight, or one more than the newest launch if none is.
    LaunchNumber oldest() const { return newest_ + 1 - launches_in_flight_.count(); }
    bool capture_is_open() const;
    void refuse_open_capture() const;
    void end_state();

    BackendState& state_;
    LaunchQueue& launches_in_flight_;
    Phase phase_ = Phase::idle;
    LaunchNumber newest_ = 0;    ///< number of the last launch, captured or not
    LaunchNumber waited_ = 0;    ///< last launch that a wait has completed
    LaunchNumber reported_ = 0;  ///< launch whose result a wait has returned, if no call came after it; 0: none
};

}  // namespace crumple::cuda
