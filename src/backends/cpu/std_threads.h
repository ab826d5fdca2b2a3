#pragma once

// Executor of builds without oneTBB: starts new threads for each loop.

#include <atomic>
#include <thread>
#include <vector>

#include "crumple/executor.h"

namespace crumple::cpu {

class StdThreads final : public Executor {
   public:
    explicit StdThreads(int threads)
        : count_(threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()) + 1) {}
    int concurrency() const override { return count_; }

    void parallel_for(std::size_t n, FunctionRef<void(std::size_t, std::size_t)> task) override {
        std::atomic<std::size_t> next{0};
        const auto work = [&](std::size_t worker) {
            for (std::size_t i; (i = next.fetch_add(1)) < n;) task(i, worker);
        };
        std::vector<std::thread> threads;
        for (int worker = 1; worker < count_; ++worker) threads.emplace_back(work, static_cast<std::size_t>(worker));
        work(0);
        for (std::thread& thread : threads) thread.join();
    }

   private:
    int count_;
};

}  // namespace crumple::cpu
