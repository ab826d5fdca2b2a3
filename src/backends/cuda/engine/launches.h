#pragma once

// Launches and waits of all queries: which launches are in flight, and whether a pass is in a caller's graph. Calls
// that are no launches end all that.

#include <cstddef>
#include <cstdint>

#include "backends/cuda/engine/finder.h"
#include "backends/device_feature_calls.h"

namespace crumple::cuda {

static_assert(Flights::slots == most_in_flight);

class Launches {
   public:
    explicit Launches(BackendState& state) : state_(state), flights_(state.flights) {}

    /// Gives a pass to `stream`, or puts it into the capture that the stream takes part in. bind(slot, room) has the
    /// finder work on a slot and brings what is asked, which is ready on both streams. `of_worlds`: for an error.
    LaunchNumber launch(Finder& finder, cudaStream_t stream, cudaStream_t other,
                        FunctionRef<void(std::size_t slot, Room room)> bind, bool of_worlds = false);

    enum class Outcome : std::uint8_t {
        complete,    ///< the finder has the result
        incomplete,  ///< a replay has not left all of it
        lost,        ///< it has to be found again
    };
    /// Throws Error unless this is the oldest launch in flight, or the one that is replayed.
    void check_awaited(LaunchNumber launch) const;
    /// After that: waits for the launch that the finder was given, or looks at what its last replay has left.
    /// `revision`: of the features that a launch was to be given.
    Outcome wait(Finder& finder, std::uint64_t revision = 0);

    /// A wait has reported the result of this launch, and no call has come after it.
    void mark_reported(LaunchNumber launch) { reported_ = launch; }
    bool has_reported(LaunchNumber launch) const { return reported_ == launch; }

    /// Launches that nobody waited for are over before their memory is used again.
    void finish();
    /// The same of a device that has failed.
    void forget();
    /// True if a caller's graph, or a launch in flight, needs the memory that is kept.
    bool needs_memory() const { return phase_ == Phase::captured || flights_.count() > 0; }
    /// True if the last call was a launch in a capture, which nothing may be freed in, and was refused.
    bool was_refused() const { return phase_ == Phase::refused; }

   private:
    enum class Phase : std::uint8_t {
        idle,
        captured,  ///< a pass is in a caller's graph, and its memory stays
        refused,   ///< a launch in a capture, which nothing may be freed in
    };

    LaunchNumber launch_in_capture(Finder& finder, bool of_worlds, bool same_capture, cudaStream_t stream,
                                   FunctionRef<void()> bind);
    Outcome wait_for_replay(Finder& finder);
    /// Returns the oldest in flight, or one more than the newest if there is none.
    LaunchNumber oldest() const { return newest_ + 1 - flights_.count(); }
    bool capture_is_open() const;
    void refuse_open_capture() const;
    void end_state();

    BackendState& state_;
    Flights& flights_;
    Phase phase_ = Phase::idle;
    LaunchNumber newest_ = 0;    ///< the one that is captured, or the newest in flight, if any is
    LaunchNumber waited_ = 0;    ///< the last that a wait has taken out of flight
    LaunchNumber reported_ = 0;  ///< by a wait, and no call came after that; 0: none
};

}  // namespace crumple::cuda
