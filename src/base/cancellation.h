#pragma once

// How a running call is asked to end before its answer is there.

#include <chrono>
#include <functional>
#include <stop_token>
#include <thread>
#include <utility>

#include "crumple/error.h"

namespace crumple {

/// One detector's. Backends call check() between pieces of work of a few milliseconds at most, from any thread.
class Cancellation {
   public:
    void set_poll(std::function<void()> poll) { poll_ = std::move(poll); }

    /// A call of this thread begins, which `stop` may end.
    void begin(std::stop_token stop) {
        stop_ = std::move(stop);
        caller_ = std::this_thread::get_id();
        polled_ = Clock::now();
    }

    /// Throws Error (cancelled) after a stop was requested. In the caller's thread also polls, and lets through what
    /// poll throws.
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
