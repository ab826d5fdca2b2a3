#pragma once

// Collective error check: either all ranks continue, or the same Error is thrown on all of them.
//
// Between two checks a rank works alone, and may fail; its error is held until the other ranks have finished this work,
// too. Of several errors, the one with the least element index over all ranks is thrown (errors without an element
// first), then the one that needs most bytes, then that of the least rank. So no rank waits for one that has failed,
// and the detectors of all ranks remain usable.

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "crumple/distributed.h"
#include "crumple/error.h"
#include "distributed/transport/transport.h"

namespace crumple::distribute {

class CollectiveCheck {
   public:
    explicit CollectiveCheck(Transport& transport) : transport_(transport) {}

    /// Runs work() on this rank. Returns once work() has succeeded on all ranks; else throws. An Error that work()
    /// throws about an element must have the element's number over all ranks. An exception that is no error, such as an
    /// interrupt by the user, is rethrown unchanged on the rank where it was thrown.
    template <class Work>
    void operator()(Phase phase, Work work) {
        std::exception_ptr failed;
        try {
            if (before) before(phase);
            work();
        } catch (...) {
            failed = std::current_exception();
        }
        throw_if_any_failed(failed);
    }

    /// Called at the beginning of each check: if it throws, the call ends on all ranks. For polls, and for tests that
    /// inject errors.
    std::function<void(Phase)> before;

   private:
    void throw_if_any_failed(const std::exception_ptr& failed);
    Error broadcast(const std::optional<Error>& mine, int root);

    Transport& transport_;
};

}  // namespace crumple::distribute
