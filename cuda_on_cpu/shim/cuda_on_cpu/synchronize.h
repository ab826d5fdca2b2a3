#pragma once

// Barriers, fences, and other functions for the threads of a block. Call sites are passed as default arguments.

#include <ctime>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/report.h"

inline void __syncthreads(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    cuda_on_cpu::Block::current().meet({"__syncthreads", file, line}, true, nullptr, nullptr, nullptr);
}

namespace cuda_on_cpu {

struct Vote {
    int predicate, result;
};

/// Waits for all threads of the block at a barrier and returns for how many of them the predicate holds.
inline int count_in_block(const Site& site, int predicate) {
    Vote mine{predicate, 0};
    const unsigned n = Block::current().size();
    meet(site, true, mine, [n](Contributions<Vote> votes) {
        int count = 0;
        for (unsigned i = 0; i < n; ++i) count += votes[i].predicate != 0;
        for (unsigned i = 0; i < n; ++i) votes[i].result = count;
    });
    return mine.result;
}

}  // namespace cuda_on_cpu

inline int __syncthreads_count(int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::count_in_block({"__syncthreads_count", file, line}, predicate);
}
inline int __syncthreads_or(int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return cuda_on_cpu::count_in_block({"__syncthreads_or", file, line}, predicate) != 0;
}
inline int __syncthreads_and(int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    const int all = static_cast<int>(cuda_on_cpu::Block::current().size());
    return cuda_on_cpu::count_in_block({"__syncthreads_and", file, line}, predicate) == all;
}

inline void __threadfence_block() { cuda_on_cpu::Block::current().fence(); }
inline void __threadfence() { cuda_on_cpu::device_fence(); }
inline void __threadfence_system() { cuda_on_cpu::device_fence(); }

/// Lets other threads run first, whatever the time. A loop that waits for another thread must call it: nothing else
/// interrupts the loop.
inline void __nanosleep(unsigned) { cuda_on_cpu::Block::current().yield(); }

[[noreturn]] inline void __trap() { cuda_on_cpu::fail_in_kernel("calls __trap"); }

/// Returns nanoseconds of the host's clock.
inline long long clock64() {
    std::timespec now{};
    std::timespec_get(&now, TIME_UTC);
    return static_cast<long long>(now.tv_sec) * 1000000000 + now.tv_nsec;
}
