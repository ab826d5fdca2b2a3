// An application that has threads of its own lends them to a detector, which then does not use those of oneTBB.

#include <array>
#include <condition_variable>
#include <cstdio>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "crumple/crumple.h"

namespace {

/// Thread pool of the application: threads that wait for work. The calling thread is worker 0.
class Pool final : public crumple::Executor {
   public:
    using Task = crumple::FunctionRef<void(std::size_t, std::size_t)>;

    explicit Pool(std::size_t workers) {
        for (std::size_t worker = 1; worker < workers; ++worker)
            threads_.emplace_back([this, worker] { serve(worker); });
    }
    ~Pool() override {
        {
            const std::lock_guard lock(mutex_);
            ends_ = true;
        }
        changed_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

    int concurrency() const override { return static_cast<int>(threads_.size()) + 1; }

    void parallel_for(std::size_t n, Task task) override {
        std::unique_lock lock(mutex_);
        task_ = &task;
        next_ = 0;
        end_ = n;
        changed_.notify_all();
        work(lock, 0);
        changed_.wait(lock, [&] { return running_ == 0; });
        task_ = nullptr;
    }

   private:
    void serve(std::size_t worker) {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [&] { return ends_ || (task_ && next_ < end_); });
            if (ends_) return;
            work(lock, worker);
        }
    }
    void work(std::unique_lock<std::mutex>& lock, std::size_t worker) {
        while (next_ < end_) {
            const std::size_t index = next_++;
            ++running_;
            lock.unlock();
            (*task_)(index, worker);
            lock.lock();
            if (--running_ == 0) changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    const Task* task_ = nullptr;
    std::size_t next_ = 0, end_ = 0, running_ = 0;
    bool ends_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace

int main() {
    // Two sheets of 2 * 100 * 100 triangles each, which cross.
    constexpr std::int32_t side = 100;
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    for (const float slope : {-0.5f, 0.5f}) {
        const auto first = static_cast<std::int32_t>(vertices.size());
        for (std::int32_t i = 0; i <= side; ++i)
            for (std::int32_t j = 0; j <= side; ++j) {
                const auto x = static_cast<float>(i), y = static_cast<float>(j);
                vertices.push_back({x, y, slope * (x - 0.4f * side)});
            }
        for (std::int32_t i = 0; i < side; ++i)
            for (std::int32_t j = 0; j < side; ++j) {
                const std::int32_t v = first + i * (side + 1) + j;
                triangles.push_back({v, v + 1, v + side + 1});
                triangles.push_back({v + 1, v + side + 2, v + side + 1});
            }
    }

    crumple::Options options;
    options.backend = crumple::Backend::cpu;
    options.executor = std::make_shared<Pool>(4);
    crumple::Detector detector(options);
    const crumple::Intersections& found = detector.find({vertices, triangles});
    std::printf("%zu pairs, on %d workers\n", found.pairs.size(), found.statistics.threads);
    return found.pairs.empty();
}
