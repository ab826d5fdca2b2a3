#pragma once

// Cancellation of a running call before its result is complete.

#include <chrono>
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
    void set_poll(std::function<void()> poll) { poll_ = std::move(poll); }

    /// Begins a call on this thread, the caller's. A stop request of `stop` cancels the call.
    void begin(std::stop_token stop) {
        stop_ = std::move(stop);
        caller_ = std::this_thread::get_id();
        polled_ = Clock::now();
    }

    /// Throws Error (cancelled) after a stop was requested. On the caller's thread, first calls the poll function (if
    /// one is set, and at most every 20 ms), and lets its exceptions through.
    void check() {
        if (poll_ && std::this_thread::get_id() == caller_ && Clock::now() - polled_ >= interval) {
            poll_();
            polled_ = Clock::now();
        }
        if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "the call was cancelled");
    }

   private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds interval{20};

    std::stop_token stop_;
    std::function<void()> poll_;
    std::thread::id caller_;
    Clock::time_point polled_;  ///< only the caller's thread reads and writes it
};

}  // namespace crumple
