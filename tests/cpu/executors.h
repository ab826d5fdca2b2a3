#pragma once

// Executors like those that host applications provide.

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "crumple/executor.h"

namespace crumple::test {

using Loop = FunctionRef<void(std::size_t, std::size_t)>;

/// Runs one task after the other on the calling thread.
struct Serial : Executor {
    int concurrency() const override { return 1; }
    void parallel_for(std::size_t n, Loop task) override {
        for (std::size_t i = 0; i < n; ++i) task(i, 0);
    }
};

/// Runs the last task first; the worker changes from task to task.
struct Backwards : Executor {
    int concurrency() const override { return 3; }
    void parallel_for(std::size_t n, Loop task) override {
        for (std::size_t i = n; i-- > 0;) task(i, i % 3);
    }
};

/// Starts new threads for each loop. The calling thread runs tasks too, or only waits.
struct Threads : Executor {
    explicit Threads(int count, bool caller_takes_tasks = true) : count(count), caller(caller_takes_tasks) {}
    int concurrency() const override { return count; }
    void parallel_for(std::size_t n, Loop task) override {
        std::atomic<std::size_t> next{0};
        const auto work = [&](std::size_t worker) {
            for (std::size_t i; (i = next.fetch_add(1)) < n;) task(i, worker);
        };
        std::vector<std::thread> threads;
        for (int worker = caller ? 1 : 0; worker < count; ++worker)
            threads.emplace_back(work, static_cast<std::size_t>(worker));
        if (caller) work(0);
        for (std::thread& thread : threads) thread.join();
    }
    const int count;
    const bool caller;
};

/// Records whether the detector breaks its side of the contract: one loop at a time, none from within a task.
struct Watched : Executor {
    explicit Watched(std::shared_ptr<Executor> executor) : inner(std::move(executor)) {}
    int concurrency() const override { return inner->concurrency(); }
    void parallel_for(std::size_t n, Loop task) override {
        overlapped = overlapped || running.exchange(true);
        ++loops;
        inner->parallel_for(n, [&](std::size_t i, std::size_t worker) {
            try {
                task(i, worker);
            } catch (...) {
                threw = true;
            }
        });
        running = false;
    }
    const std::shared_ptr<Executor> inner;
    std::atomic<bool> running{false}, overlapped{false}, threw{false};
    int loops = 0;
};

}  // namespace crumple::test
