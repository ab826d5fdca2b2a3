// Workers: OS threads that serve all launches until the number of workers or the seed changes. Each has one Block
// object, which it reuses, and takes the next block of a launch from a counter. Host and workers signal each other by
// C++20 waits, which ThreadSanitizer does not see; the only edges that it may see are those of LaunchEdges. A mutex
// would order the blocks of one launch, and hide their races.

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu {
namespace {

/// Launch in progress. Its blocks are visited from `first` in steps of `stride` modulo `blocks`; the two are coprime.
struct Launch {
    const Kernel* kernel;
    std::uint64_t blocks, first, stride;
    std::atomic<std::uint64_t> next{0};
    LaunchEdges edges;
    std::unique_ptr<LaunchCounts> counts;

    uint3 block(std::uint64_t number) const {
        const dim3& grid = kernel->grid;
        const auto i = static_cast<std::uint64_t>((static_cast<unsigned __int128>(number) * stride + first) % blocks);
        return {static_cast<unsigned>(i % grid.x), static_cast<unsigned>(i / grid.x % grid.y),
                static_cast<unsigned>(i / grid.x / grid.y)};
    }
};

class Worker {
   public:
    explicit Worker(std::atomic<unsigned>& busy) : busy_(busy), thread_([this] { work(); }) {}
    ~Worker() {
        give(nullptr);
        thread_.join();
    }
    /// Starts work on a launch, and decrements `busy` at its end. Null ends the worker.
    void give(Launch* launch) {
        launch_.store(launch);
        orders_.fetch_add(1);
        orders_.notify_one();
    }

   private:
    void work() {
        std::fesetenv(FE_DFL_ENV);  // a device has no other floating-point mode
        explain_faults();
        Block block;
        for (unsigned done = 0;; ++done) {
            orders_.wait(done);
            Launch* launch = launch_.load();
            if (!launch) return;
            for (std::uint64_t number; (number = launch->next.fetch_add(1)) < launch->blocks;)
                block.run(*launch->kernel, launch->edges, launch->block(number), launch->counts.get());
            if (busy_.fetch_sub(1) == 1) busy_.notify_one();
        }
    }

    std::atomic<unsigned>& busy_;
    std::atomic<Launch*> launch_{nullptr};
    std::atomic<unsigned> orders_{0};
    std::thread thread_;
};

class Workers {
   public:
    Workers(unsigned count, std::uint32_t seed) : seed_(seed), random_(seed), all_(count) {}
    /// True if the settings still have this number of workers and this seed, with which each worker's Block was made.
    bool fit() const { return all_.size() == worker_count() && seed_ == settings().seed; }

    void run(const Kernel& kernel) {
        Launch launch;
        launch.kernel = &kernel;
        launch.blocks = std::uint64_t{kernel.grid.x} * kernel.grid.y * kernel.grid.z;
        choose_walk(launch);
        const unsigned threads = kernel.block.x * kernel.block.y * kernel.block.z;
        launch.counts = counts_of_launch(kernel.function, launch.blocks * ((threads + warp_size - 1) / warp_size));
        const auto used = static_cast<unsigned>(std::min<std::uint64_t>(launch.blocks, all_.size()));
        busy_ = used;
        release_edge(&launch.edges.begin);
        for (unsigned i = 0; i < used; ++i) {
            if (!all_[i]) all_[i] = std::make_unique<Worker>(busy_);
            all_[i]->give(&launch);
        }
        for (unsigned left; (left = busy_.load()) != 0;) busy_.wait(left);
        acquire_edge(&launch.edges.end);
        if (launch.counts) finish(*launch.counts);
    }

   private:
    void choose_walk(Launch& launch) {
        const std::uint64_t n = launch.blocks;
        launch.first = 0;
        launch.stride = 1;
        if (settings().order == Order::reverse) {
            launch.first = n - 1;
            launch.stride = n - 1 + (n == 1);  // -1 modulo n, or 1 if n is 1
        } else if (settings().order == Order::random) {
            launch.first = random_.below(n);
            do launch.stride = 1 + random_.below(n);
            while (std::gcd(launch.stride, n) != 1);
        }
    }

    std::uint32_t seed_;
    Random random_;
    std::atomic<unsigned> busy_{0};
    std::vector<std::unique_ptr<Worker>> all_;
};

}  // namespace

void run_grid(const Kernel& kernel) {
    if (const auto& run_instead = settings().run_instead; run_instead && run_instead(kernel)) return;
    static std::unique_ptr<Workers> workers;
    if (!workers || !workers->fit()) workers = std::make_unique<Workers>(worker_count(), settings().seed);
    workers->run(kernel);
}

}  // namespace cuda_on_cpu
