#pragma once

#include <chrono>

namespace crumple {

/// Stopwatch: lap() returns the milliseconds since the last lap(), or since construction.
class Stopwatch {
   public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double passed = std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
        return passed;
    }

   private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace crumple
