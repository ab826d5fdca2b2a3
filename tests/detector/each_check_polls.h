#pragma once

#include <chrono>

#include "base/cancellation.h"

namespace crumple::test {

/// Guard: as long as it lives, a detector polls at each of its checks for a stop request on the caller's thread, not
/// only every 20 ms: so a count of polls does not depend on the speed of the machine.
class EachCheckPolls {
   public:
    EachCheckPolls() { Cancellation::poll_interval = std::chrono::milliseconds(0); }
    ~EachCheckPolls() { Cancellation::poll_interval = usual_; }
    EachCheckPolls(const EachCheckPolls&) = delete;
    EachCheckPolls& operator=(const EachCheckPolls&) = delete;

   private:
    const std::chrono::milliseconds usual_ = Cancellation::poll_interval;
};

}  // namespace crumple::test
