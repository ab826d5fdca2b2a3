#pragma once

// The only place where the cpu backend uses threads: an arena of workers, oneTBB's or an Executor that the application
// provides, and a parallel loop.
//
// With CRUMPLE_STD_THREADS, plain std::thread replaces oneTBB: for ThreadSanitizer, which reports false races within
// oneTBB. Either way, each task holds a FloatEnvironment, and `worker` is below workers() and unique among the tasks
// that run at the same time, so that each worker can have scratch memory of its own. Before each task, a loop throws if
// the call was cancelled.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>

#include "base/cancellation.h"
#include "base/float_environment.h"
#include "crumple/options.h"

#ifdef CRUMPLE_STD_THREADS
#include "backends/cpu/std_threads.h"
#else
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace crumple::cpu {

class Workers {
   public:
#ifdef CRUMPLE_STD_THREADS
    Workers(const Options& options, Cancellation& cancellation)
        : executor_(options.executor ? options.executor : std::make_shared<StdThreads>(options.threads)),
          cancellation_(cancellation) {}
    int workers() const { return executor_->concurrency(); }
    bool nests() const { return false; }

    template <class Function>
    void run(Function function) {
        function();
    }
    template <class Task>
    void parallel_for(std::size_t n, Task task) {
        parallel_for_lent(n, task);
    }
#else
    /// Starts the threads at once. If the first call had to start them, it would take a third longer in a small scene.
    Workers(const Options& options, Cancellation& cancellation)
        : executor_(options.executor),
          arena_(options.threads > 0 ? std::min(options.threads, allowed()) : tbb::task_arena::automatic),
          cancellation_(cancellation) {
        if (!executor_ && workers() > 1) arena_.enqueue([] {});
    }
    int workers() const { return executor_ ? executor_->concurrency() : arena_.max_concurrency(); }

    /// True if a task may start a parallel loop.
    bool nests() const { return !executor_; }

    /// Runs `function` inside the arena. Parallel loops must be called from there.
    template <class Function>
    void run(Function function) {
        if (executor_)
            function();
        else
            arena_.execute(function);
    }

    /// Calls task(i, worker) for i in [0, n), in any order, one index per task. The loop is isolated: a worker that
    /// waits for its end runs no task from outside the loop, so that per-worker scratch of an enclosing task stays
    /// untouched.
    template <class Task>
    void parallel_for(std::size_t n, Task task) {
        if (executor_) {
            parallel_for_lent(n, task);
            return;
        }
        tbb::this_task_arena::isolate([&] {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, n, 1),
                [&](const tbb::blocked_range<std::size_t>& range) {
                    const FloatEnvironment environment;
                    const auto worker = static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
                    for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        cancellation_.check();
                        task(i, worker);
                    }
                },
                tbb::simple_partitioner());
        });
    }
#endif

   private:
    // An Executor need not handle exceptions: the first one is stored and rethrown after the loop, and the tasks after
    // it do nothing.
    template <class Task>
    void parallel_for_lent(std::size_t n, const Task& task) {
        std::atomic<bool> failed{false};
        std::exception_ptr failure;
        std::mutex mutex;
        const auto guarded = [&](std::size_t i, std::size_t worker) {
            if (failed.load(std::memory_order_relaxed)) return;
            const FloatEnvironment environment;
            try {
                cancellation_.check();
                task(i, worker);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
                failed.store(true, std::memory_order_relaxed);
            }
        };
        if (n == 1)
            guarded(0, 0);  // wakes no other thread
        else if (n > 1)
            executor_->parallel_for(n, guarded);
        if (failure) std::rethrow_exception(failure);
    }

#ifndef CRUMPLE_STD_THREADS
    /// Returns how many threads oneTBB allows in this process, usually the number of cores. If more were requested,
    /// oneTBB would print a warning of its own.
    static int allowed() {
        return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    }
#endif

    std::shared_ptr<Executor> executor_;
#ifndef CRUMPLE_STD_THREADS
    tbb::task_arena arena_;
#endif
    Cancellation& cancellation_;
};

}  // namespace crumple::cpu
