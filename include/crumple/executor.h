#pragma once

#include <cstddef>

#include "crumple/function_ref.h"

namespace crumple {

/// Threads that a host application lends to detectors (Options::executor): its scheduler in place of oneTBB.
///
/// A detector runs one loop after another, each from the thread that made the call, and none from within a task, so an
/// executor need not nest. Tasks do not wait for each other: an executor may run them one by one. Tasks take from some
/// microseconds to some milliseconds each. Detectors that work at the same time, in several threads, start loops at the
/// same time: an executor that they share must allow that.
class Executor {
   public:
    virtual ~Executor() = default;

    /// How many workers there are, 1 to 1024. Always the same number: each worker has buffers of its own.
    virtual int concurrency() const = 0;

    /// Calls task(index, worker) once for each index in [0, n), in any order, on any threads, and returns when all
    /// these calls have returned; what they wrote must be visible to the caller then, as after a join. `worker` is in
    /// [0, concurrency()), and of the calls of one loop that run at the same time no two have the same one. Tasks do
    /// not throw: the detector keeps what is thrown inside them and throws it after the loop. What parallel_for()
    /// itself throws, once no task runs any more, ends the detector's call.
    ///
    /// The calling thread had better take tasks, too: only there Detector::set_poll()'s function is called.
    virtual void parallel_for(std::size_t n, FunctionRef<void(std::size_t index, std::size_t worker)> task) = 0;
};

}  // namespace crumple
