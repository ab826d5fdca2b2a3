#include "cuda_on_cpu/machine/counts.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <tuple>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/kernel_name.h"
#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/machine/settings.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"

namespace cuda_on_cpu {
namespace {

/// Counts by kernel, in the order of first launches. Used by the host's thread alone, which waits for each launch.
struct AllCounts {
    bool on = false;
    std::vector<KernelCounts> kernels;
};
AllCounts& all_counts() {
    static AllCounts instance;
    return instance;
}

void add(AtomicCounts& sum, const AtomicCounts& more) {
    sum.lanes += more.lanes;
    sum.instructions += more.instructions;
    sum.parts += more.parts;
}
void add(KernelCounts& sum, const KernelCounts& more) {
    sum.launches += more.launches;
    sum.warps += more.warps;
    sum.meetings += more.meetings;
    sum.warp_steps += more.warp_steps;
    sum.lane_steps += more.lane_steps;
    add(sum.global, more.global);
    add(sum.shared, more.shared);
    sum.addresses = std::max(sum.addresses, more.addresses);
    sum.most_at_one = std::max(sum.most_at_one, more.most_at_one);
    sum.most_instructions = std::max(sum.most_instructions, more.most_instructions);
}

template <class... Arguments>
void append(std::string& text, const char* format, Arguments... arguments) {
    char line[400];
    std::snprintf(line, sizeof line, format, arguments...);
    text += line;
}

double ratio(std::uint64_t a, std::uint64_t b) { return b ? static_cast<double>(a) / static_cast<double>(b) : 0; }

}  // namespace

void start_counting() { all_counts() = {true, {}}; }

std::vector<KernelCounts> stop_counting() {
    all_counts().on = false;
    return std::move(all_counts().kernels);
}

std::string table(const std::vector<KernelCounts>& counts) {
    std::string text;
    append(text, "%-28s %5s %8s %9s %10s %7s | %9s %9s %9s %9s %9s %9s | %9s %9s\n", "kernel", "runs", "warps",
           "meetings", "warp steps", "lanes %", "atomics", "by warps", "parts", "addresses", "most at 1", "by warps",
           "shared", "parts");
    for (const KernelCounts& k : counts)
        append(text, "%-28s %5lu %8lu %9lu %10lu %7.1f | %9lu %9lu %9lu %9lu %9lu %9lu | %9lu %9lu\n",
               kernel_name(k.function).c_str(), k.launches, k.warps, k.meetings, k.warp_steps,
               100 * ratio(k.lane_steps, warp_size * k.warp_steps), k.global.lanes, k.global.instructions,
               k.global.parts, k.addresses, k.most_at_one, k.most_instructions, k.shared.lanes, k.shared.parts);
    return text;
}

void start_of_profile() {
    if (!settings().counts) return;
    cudaDeviceSynchronize();
    start_counting();
}

void end_of_profile() {
    if (!settings().counts) return;
    cudaDeviceSynchronize();
    std::fprintf(stderr, "%s\n", table(stop_counting()).c_str());
}

LaunchCounts::LaunchCounts(const void* function, std::uint64_t warps) {
    sum_.function = function;
    sum_.launches = 1;
    sum_.warps = warps;
}

std::unique_ptr<LaunchCounts> counts_of_launch(const void* function, std::uint64_t warps) {
    // To ThreadSanitizer, the logs of a block's threads would be shared memory that nothing protects.
    return all_counts().on && !thread_sanitizer ? std::make_unique<LaunchCounts>(function, warps) : nullptr;
}

void finish(const LaunchCounts& launch) {
    KernelCounts sum = launch.sum_;
    sum.addresses = launch.by_address_.size();
    for (const auto& [address, at] : launch.by_address_) {
        sum.most_at_one = std::max(sum.most_at_one, at.lanes);
        sum.most_instructions = std::max(sum.most_instructions, at.instructions);
    }
    auto& kernels = all_counts().kernels;
    const auto found =
        std::find_if(kernels.begin(), kernels.end(), [&](const auto& k) { return k.function == sum.function; });
    found == kernels.end() ? kernels.push_back(sum) : add(*found, sum);
}

void BlockCounts::begin(LaunchCounts& launch, unsigned threads) {
    launch_ = &launch;
    threads_ = threads;
    if (logs_.size() < threads) logs_.resize(threads);
}

void BlockCounts::step(unsigned rank, const void* place) { logs_[rank].steps.push_back(place); }

void BlockCounts::atomic(unsigned rank, const void* address, bool shared, const char* file, int line) {
    auto& atomics = logs_[rank].atomics;
    unsigned occurrence = 0;
    for (auto a = atomics.rbegin(); a != atomics.rend(); ++a)
        if (a->line == line && std::strcmp(a->file, file) == 0) {
            occurrence = a->occurrence + 1;
            break;
        }
    atomics.push_back({file, line, shared, occurrence, address});
}

void BlockCounts::meet(unsigned warp, std::uint32_t lanes) {
    ++sum_.meetings;
    evaluate(warp, lanes);
}

void BlockCounts::end() {
    for (unsigned warp = 0; warp * warp_size < threads_; ++warp) evaluate(warp, ~0u);
    const std::lock_guard lock(launch_->mutex_);
    add(launch_->sum_, sum_);
    for (const auto& [address, at] : by_address_) {
        launch_->by_address_[address].lanes += at.lanes;
        launch_->by_address_[address].instructions += at.instructions;
    }
    sum_ = {};
    by_address_.clear();
}

void BlockCounts::evaluate(unsigned warp, std::uint32_t lanes) {
    ++evaluations_;
    together_.clear();
    for (; lanes; lanes &= lanes - 1) {
        const auto lane = static_cast<unsigned>(std::countr_zero(lanes));
        const unsigned rank = warp * warp_size + lane;
        if (rank >= threads_) break;
        Log& log = logs_[rank];
        for (const void* place : log.steps) {
            Executions& e = executions_[place];
            if (e.evaluation != evaluations_) e = {evaluations_, 0, 0, lane};
            if (e.lane != lane) e.lane = lane, e.by_lane = 0;
            if (++e.by_lane > e.most) e.most = e.by_lane, ++sum_.warp_steps;
        }
        sum_.lane_steps += log.steps.size();
        together_.insert(together_.end(), log.atomics.begin(), log.atomics.end());
        log.steps.clear();
        log.atomics.clear();
    }
    evaluate_atomics();
}

// Sorts the atomics of several lanes, so that those of one instruction are neighbours, and in them those of one
// address.
void BlockCounts::evaluate_atomics() {
    const auto instruction = [](const Atomic& a) { return std::tuple(a.file, a.line, a.occurrence, a.shared); };
    std::sort(together_.begin(), together_.end(), [&](const Atomic& a, const Atomic& b) {
        return std::tuple(instruction(a), a.address) < std::tuple(instruction(b), b.address);
    });
    for (std::size_t i = 0; i < together_.size(); ++i) {
        const Atomic& a = together_[i];
        const bool new_instruction = i == 0 || instruction(a) != instruction(together_[i - 1]);
        const bool new_part = new_instruction || a.address != together_[i - 1].address;
        AtomicCounts& counts = a.shared ? sum_.shared : sum_.global;
        ++counts.lanes;
        counts.instructions += new_instruction;
        counts.parts += new_part;
        if (a.shared) continue;
        LaunchCounts::AtAddress& at = by_address_[a.address];
        ++at.lanes;
        at.instructions += new_part;
    }
}

void note_atomic(const void* address, const char* file, int line) {
    if (Block* block = Block::running()) block->note_atomic(address, file, line);
}

}  // namespace cuda_on_cpu

/// Called by the compiler's instrumentation at the start of each basic block (-fsanitize-coverage=trace-pc).
extern "C" void __sanitizer_cov_trace_pc() {
    if (cuda_on_cpu::Block* block = cuda_on_cpu::Block::running()) block->note_step(__builtin_return_address(0));
}
