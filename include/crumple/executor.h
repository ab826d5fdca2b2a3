#pragma once

#include <cstddef>

#include "crumple/function_ref.h"

namespace crumple {

/// Thread pool of a host application, used by detectors instead of oneTBB (Options::executor).
///
/// A detector runs one loop after another, each from the thread that made the call, and none from within a task, so an
/// executor need not support nested loops. Tasks do not wait for each other: an executor may run them one by one. A
/// task takes some microseconds to some milliseconds. Detectors that work at the same time, in several threads, start
/// loops at the same time: an executor that they share must support that.
class Executor {
   public:
    virtual ~Executor() = default;

    /// Returns the number of workers, 1 to 1024. The number must not change, because detectors have buffers for each
    /// worker.
    virtual int concurrency() const = 0;

    /// Calls task(index, worker) once for each index in [0, n), in any order, on any threads, and returns when all
    /// calls have returned; their writes must then be visible to the caller, as after a join. `worker` is in [0,
    /// concurrency()) and differs between calls that run at the same time. Tasks do not throw: the detector stores
    /// exceptions from inside them and throws after the loop. An exception from parallel_for() itself, thrown when no
    /// task runs any more, ends the detector's call.
    ///
    /// The calling thread should run tasks, too: the function of Detector::set_poll() is called only there.
    virtual void parallel_for(std::size_t n, FunctionRef<void(std::size_t index, std::size_t worker)> task) = 0;
};

}  // namespace crumple
