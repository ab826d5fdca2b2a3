#pragma once

// Cancellation of a running call before its result is complete.

#include <chrono>
#include <cstddef>
#include <functional>
#include <stop_token>
#include <thread>
#include <utility>

#include "crumple/error.h"

namespace crumple {

/// Cancellation state of one detector. Backends and searches call check() between pieces of work of a few milliseconds
/// at most, from any thread.
class Cancellation {
   public:
    /// Shortest time between two polls (calls of the poll function of a detector), for all detectors. Tests set 0, so
    /// that each check() on the caller's thread polls, and count the polls. Must not change during a call.
    static inline std::chrono::milliseconds poll_interval{20};

    void set_poll(std::function<void()> poll) { poll_ = std::move(poll); }

    /// Begins a call on this thread, the caller's. A stop request of `stop` cancels the call.
    void begin(std::stop_token stop) {
        stop_ = std::move(stop);
        caller_ = std::this_thread::get_id();
        polled_ = Clock::now();
        poll_threw_ = false;
    }

    /// Throws Error (cancelled) after a stop was requested. On the caller's thread, first calls the poll function (if
    /// one is set, and at most every `poll_interval`), and lets its exceptions through.
    void check() {
        if (poll_ && std::this_thread::get_id() == caller_ && Clock::now() - polled_ >= poll_interval) {
            poll_threw_ = true;
            poll_();
            poll_threw_ = false;
            polled_ = Clock::now();
        }
        if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "the call was cancelled");
    }

    /// True if a stop of the current call was requested, or the poll function threw during it. Call it only on the
    /// caller's thread.
    bool stopped() const { return poll_threw_ || stop_.stop_requested(); }

   private:
    using Clock = std::chrono::steady_clock;

    std::stop_token stop_;
    std::function<void()> poll_;
    std::thread::id caller_;
    Clock::time_point polled_;  ///< time of the last poll, or of begin(); used by the caller's thread only
    bool poll_threw_ = false;
};

/// Calls body(i) for each i in [0, n), in order, and checks for cancellation after every 65,536 calls. For loops over
/// the rows of a result, whose single calls are cheap.
template <class Body>
void for_each_checked(std::size_t n, Cancellation& cancellation, Body body) {
    constexpr std::size_t block = 1 << 16;
    for (std::size_t begin = 0; begin < n; begin += block) {
        cancellation.check();
        const std::size_t end = begin + block < n ? begin + block : n;
        for (std::size_t i = begin; i < end; ++i) body(i);
    }
}

}  // namespace crumple
