#pragma once

// The one seam through which the cpu backend uses threads: an arena of workers and a parallel loop.
//
// With CRUMPLE_STD_THREADS it is plain std::thread, which ThreadSanitizer understands (it reports races inside a clean
// oneTBB). Either way each task holds the floating point environment, and `worker` is below `workers()` and unique
// among the tasks that run at the same time, so that scratch memory can be one per worker. Before each task a
// loop looks whether the call was cancelled, and throws.

#include <atomic>
#include <cstddef>

#include "base/cancellation.h"
#include "base/float_environment.h"

#ifdef CRUMPLE_STD_THREADS
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace crumple::cpu {

class Workers {
   public:
#ifdef CRUMPLE_STD_THREADS
    Workers(int threads, Cancellation& cancellation)
        : count_(threads > 0 ? threads : default_count()), cancellation_(cancellation) {}
    int workers() const { return count_; }

    template <class Function>
    void run(Function function) {
        function();
    }

    /// Calls task(i, worker) for i in [0, n), in any order. Tasks of a nested loop run on the caller's worker.
    template <class Task>
    void parallel_for(std::size_t n, Task task) {
        if (inside_ || count_ == 1 || n < 2) {
            for (std::size_t i = 0; i < n; ++i) {
                cancellation_.check();
                task(i, static_cast<std::size_t>(worker_));
            }
            return;
        }
        std::atomic<std::size_t> next{0};
        std::exception_ptr failure;
        std::mutex mutex;
        const auto work = [&](int worker) {
            const FloatEnvironment environment;
            inside_ = true;
            worker_ = worker;
            try {
                for (std::size_t i; (i = next.fetch_add(1)) < n;) {
                    cancellation_.check();
                    task(i, static_cast<std::size_t>(worker));
                }
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
                next = n;
            }
            inside_ = false;
            worker_ = 0;
        };
        std::vector<std::thread> threads;
        for (int worker = 1; worker < count_; ++worker) threads.emplace_back(work, worker);
        work(0);
        for (std::thread& thread : threads) thread.join();
        if (failure) std::rethrow_exception(failure);
    }

   private:
    static int default_count() { return static_cast<int>(std::thread::hardware_concurrency()) + 1; }
    int count_;
    Cancellation& cancellation_;
    static inline thread_local bool inside_ = false;
    static inline thread_local int worker_ = 0;
#else
    /// The threads start now, so that the first call does not have to: that would take a third longer in a small scene.
    Workers(int threads, Cancellation& cancellation)
        : arena_(threads > 0 ? threads : tbb::task_arena::automatic), cancellation_(cancellation) {
        if (workers() > 1) arena_.enqueue([] {});
    }
    int workers() const { return arena_.max_concurrency(); }

    /// Runs `function` inside the arena; parallel loops belong there.
    template <class Function>
    void run(Function function) {
        arena_.execute(function);
    }

    /// Calls task(i, worker) for i in [0, n), in any order, one index a task. The loop is isolated: while a worker
    /// waits for its end it takes no task from outside, so that per-worker scratch of an enclosing task stays
    /// untouched.
    template <class Task>
    void parallel_for(std::size_t n, Task task) {
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

   private:
    tbb::task_arena arena_;
    Cancellation& cancellation_;
#endif
};

}  // namespace crumple::cpu
