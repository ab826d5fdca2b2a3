#pragma once

// Sets the number of threads that oneTBB allows in the process. The library itself never raises it: that is left to its
// users.

#include <cstddef>

#ifdef CRUMPLE_WITH_TBB
#include <tbb/global_control.h>
#endif

namespace crumple::cli {

/// Allows this number of threads during its lifetime.
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
