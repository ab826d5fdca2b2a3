#pragma once

// Counts of the work of kernels, by kernel. They do not show how long a kernel takes on a device, but how much of a
// warp's work is wasted, and which atomics a device has to serialise.
//
// A device executes the lanes of a warp together, while the emulator runs one lane after another. So the work of a warp
// is reconstructed from logs of its lanes. A log begins when lanes meet (in a vote, a shuffle or a barrier), and ends
// when they meet again or have exited. It is assumed that lanes diverge as little as possible in between:
//
//   - A step is one execution of a basic block of the kernel's code. If lane i executes a block k_i times between two
//     meetings, the warp executes it max(k_i) times: max(k_i) warp steps and sum(k_i) lane steps.
//   - The n-th atomics of all lanes at the same place in the source are one instruction of the warp.
//
// Steps are counted only in code that was compiled with -fsanitize-coverage=trace-pc (CMake option CUDA_ON_CPU_STEPS).
// The blocks are those of the host's compiler; the code inside a meeting, and thus inside CUB's primitives, has no
// steps. Loops that wait in __nanosleep have as many steps as the emulator's order of threads implies.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

namespace cuda_on_cpu {

/// Atomics of one kind of memory. A device can do an instruction in as few parts as it has different addresses.
struct AtomicCounts {
    std::uint64_t lanes = 0;         ///< atomics, each counted for every lane that executes it
    std::uint64_t instructions = 0;  ///< atomics, counted once for the lanes of a warp that execute it together
    std::uint64_t parts = 0;         ///< sum over all instructions: number of different addresses
};

/// Work of all launches of a kernel while counting was on.
struct KernelCounts {
    const void* function = nullptr;
    std::uint64_t launches = 0, warps = 0;
    std::uint64_t meetings = 0;  ///< votes, shuffles, ..., and barriers, counted once for each warp
    std::uint64_t warp_steps = 0, lane_steps = 0;
    AtomicCounts global, shared;
    std::uint64_t addresses = 0;          ///< different addresses of global atomics, in the launch that has most
    std::uint64_t most_at_one = 0;        ///< most global atomics on one address in one launch, counted for every lane
    std::uint64_t most_instructions = 0;  ///< most instructions with global atomics on one address in one launch
};

/// Begins to count, from zero. The caller must have waited for all earlier launches.
void start_counting();
/// Ends counting and returns the counts in the order of the kernels' first launches. The caller must have waited for
/// all launches that are to be counted.
std::vector<KernelCounts> stop_counting();

/// Returns a table of counts, one line per kernel, with a header.
std::string table(const std::vector<KernelCounts>& counts);

/// Called at the start and the end of the range that a profiler records. If `settings().counts`, they wait for the
/// device; counting is on in between, and the table is printed on stderr.
void start_of_profile();
void end_of_profile();

/// Sums of one launch, to which all workers add.
class LaunchCounts {
   public:
    LaunchCounts(const void* function, std::uint64_t warps);

   private:
    friend class BlockCounts;
    friend void finish(const LaunchCounts& launch);
    struct AtAddress {
        std::uint64_t lanes = 0, instructions = 0;
    };
    std::mutex mutex_;
    KernelCounts sum_;
    std::unordered_map<const void*, AtAddress> by_address_;
};

/// Returns the sums for a launch that begins; null if counting is off.
std::unique_ptr<LaunchCounts> counts_of_launch(const void* function, std::uint64_t warps);
/// Adds the sums of a launch that has ended to those of its kernel.
void finish(const LaunchCounts& launch);

/// Logs of the threads of the block that a worker runs.
class BlockCounts {
   public:
    /// Prepares for a block with this number of threads.
    void begin(LaunchCounts& launch, unsigned threads);
    /// Notes a step or an atomic of the thread `rank`.
    void step(unsigned rank, const void* place);
    void atomic(unsigned rank, const void* address, bool shared, const char* file, int line);
    /// Notes a meeting of lanes of a warp: evaluates and clears their logs.
    void meet(unsigned warp, std::uint32_t lanes);
    /// Evaluates all remaining logs, and adds the block's counts to those of the launch.
    void end();

   private:
    struct Atomic {
        const char* file;
        int line;
        bool shared;
        unsigned occurrence;  // index among the atomics of the lane's log at the same place
        const void* address;
    };
    struct Log {
        std::vector<const void*> steps;
        std::vector<Atomic> atomics;
    };
    // Executions of a basic block since the last evaluation: by the last lane that has been evaluated; the largest
    // number of any lane.
    struct Executions {
        std::uint64_t evaluation = 0, by_lane = 0, most = 0;
        unsigned lane = 0;
    };
    void evaluate(unsigned warp, std::uint32_t lanes);
    void evaluate_atomics();

    LaunchCounts* launch_ = nullptr;
    unsigned threads_ = 0;
    KernelCounts sum_;
    std::unordered_map<const void*, LaunchCounts::AtAddress> by_address_;
    std::vector<Log> logs_;  // by rank
    std::unordered_map<const void*, Executions> executions_;
    std::uint64_t evaluations_ = 0;
    std::vector<Atomic> together_;  // atomics of the lanes that are being evaluated
};

}  // namespace cuda_on_cpu
