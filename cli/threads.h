#pragma once

// Sets the number of threads that oneTBB allows in the process (a global limit). The library never raises this limit;
// its users, such as this command line, may.

#include <cstddef>

#ifdef CRUMPLE_WITH_TBB
#include <tbb/global_control.h>
#endif

namespace crumple::cli {

/// Allows `count` threads as long as this object lives. No effect in builds without oneTBB.
class AllowedThreads {
   public:
#ifdef CRUMPLE_WITH_TBB
    explicit AllowedThreads(int count)
        : control_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)) {}

   private:
    tbb::global_control control_;
#else
    explicit AllowedThreads(int) {}
#endif
};

}  // namespace crumple::cli
