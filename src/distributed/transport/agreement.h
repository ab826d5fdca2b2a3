#pragma once

// How ranks end a phase: all of them go on, or the same Error is thrown on all of them.
//
// Between two agreements a rank works alone, and may fail; what it throws is kept until the others are ready. The least
// element wins, counted over all ranks, then the least rank; of memory limits the one that needs most. So nobody waits
// for a rank that has failed, and every rank's detector goes on.

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "crumple/distributed.h"
#include "crumple/error.h"
#include "distributed/transport/transport.h"

namespace crumple::distribute {

class Agreement {
   public:
    explicit Agreement(Transport& transport) : transport_(transport) {}

    /// Runs work() here. Returns if it has returned on all ranks. An Error that names an element has its index over all
    /// ranks, if a GlobalIndex has made it so. What is no Error, such as an interrupt, is thrown as it is on its rank.
    template <class Work>
    void operator()(Phase phase, Work work) {
        std::exception_ptr failed;
        try {
            if (before) before(phase);
            work();
        } catch (...) {
            failed = std::current_exception();
        }
        settle(failed);
    }

    /// Called at the beginning of each phase, within what is settled; for tests, which fail there, and for polls.
    std::function<void(Phase)> before;

   private:
    void settle(const std::exception_ptr& failed);
    Error share(const std::optional<Error>& mine, int root);

    Transport& transport_;
};

}  // namespace crumple::distribute
