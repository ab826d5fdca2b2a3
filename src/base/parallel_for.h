#pragma once

// How what comes before a backend borrows its threads.

#include <cstddef>

#include "crumple/function_ref.h"

namespace crumple {

using Task = FunctionRef<void(std::size_t)>;

/// Something that runs task(i) for i in [0, n), in any order and perhaps several at once. If one throws, so
/// does the loop.
class ParallelFor {
   public:
    virtual ~ParallelFor() = default;
    virtual void parallel_for(std::size_t n, Task task) {
        for (std::size_t i = 0; i < n; ++i) task(i);
    }
};

}  // namespace crumple
