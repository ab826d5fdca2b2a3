#pragma once

// Launches and waits of all queries: which launches are in flight, what each of them asks, and whether a pass is in a
// caller's graph. Calls that are no launches end all that.

#include <array>
#include <cstddef>
#include <cstdint>

#include "backends/cuda/engine/finder.h"
#include "backends/device_feature_calls.h"

namespace crumple::cuda {

class Launches {
   public:
    explicit Launches(BackendState& state) : state_(state), flights_(state.flights) {}

    /// Gives a pass to `stream`, or puts it into the capture that the stream takes part in. bind(slot, room) has the
    /// finder work on a slot and brings what is asked, which is ready on both streams.
    void launch(Finder& finder, Asked question, cudaStream_t stream, cudaStream_t other,
                FunctionRef<void(std::size_t slot, Room room)> bind);

    enum class Outcome : std::uint8_t {
        complete,    ///< the finder has the result
        incomplete,  ///< a replay has not left all of it
        lost,        ///< it has to be found again
    };
    /// Throws Error unless the oldest launch in flight, or the one that is replayed, asks that.
    void check_awaited(Asked question) const;
    /// After that: waits for the launch, or looks at what its last replay has left. `revision`: of the features that a
    /// launch was to be given.
    Outcome wait(Finder& finder, Asked question, std::uint64_t revision = 0);
    /// True if what is waited for, a replay or the oldest launch in flight, asks that.
    bool awaits(Asked question) const;

    /// A wait has reported the launch that asked that, and no call has come after it.
    void mark_reported(Asked question);
    bool has_reported(Asked question) const;

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
        reported,  ///< by a wait, and no call came after that
        captured,  ///< a pass is in a caller's graph, and its memory stays
        refused,   ///< a launch in a capture, which nothing may be freed in
    };

    void launch_in_capture(Finder& finder, Asked question, bool same_capture, cudaStream_t stream,
                           FunctionRef<void()> bind);
    Outcome wait_for_replay(Finder& finder, Asked question);
    bool capture_is_open() const;
    void refuse_open_capture() const;
    void end_state();

    BackendState& state_;
    Flights& flights_;
    Phase phase_ = Phase::idle;
    bool replayed_ = false;                      ///< since the capture: a wait has reported it
    std::array<Asked, Flights::slots> asked_{};  ///< by slot
    Asked captured_{}, reported_{};
};

}  // namespace crumple::cuda
