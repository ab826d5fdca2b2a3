#pragma once

// Parallel loop that lends a backend's threads to code outside the backend.

#include <cstddef>

#include "crumple/function_ref.h"

namespace crumple {

using Task = FunctionRef<void(std::size_t)>;

/// Parallel loop: parallel_for() runs task(i) for each i in [0, n), in any order and perhaps several at once. It throws
/// if a task does. This base class runs the tasks one after the other; subclasses may use threads.
class ParallelFor {
   public:
    virtual ~ParallelFor() = default;
    virtual void parallel_for(std::size_t n, Task task) {
        for (std::size_t i = 0; i < n; ++i) task(i);
    }
};

}  // namespace crumple
