#pragma once

// Ends a call as soon as its pairs are certain not to fit the memory limit, instead of counting them to the end.

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "backends/duplicates.h"
#include "results/intersection_output.h"

namespace crumple {

/// Not even the result fits the limit, however it is found: no other way need be tried.
struct ResultExceeds : MemoryMeter::Exceeded {};

class PairBudget {
   public:
    /// What is asked; see count_duplicates().
    struct Call {
        const Scene& scene;
        const Query& query;
        const GroupRule& rule;
        const Levels& levels;
    };

    /// Duplicates are counted when so many pairs a triangle were found.
    PairBudget(const Call& call, MemoryMeter& meter, std::int64_t pairs_a_triangle)
        : call_(call), meter_(meter), next_(pairs_a_triangle * call.scene.triangle_count()) {}

    /// So many more pairs were found, each for the first time. From any thread. Throws ResultExceeds with the bytes
    /// that are needed at least.
    void add(std::int64_t pairs) {
        const std::int64_t found = found_.fetch_add(pairs, std::memory_order_relaxed) + pairs;
        if (least_.load(std::memory_order_relaxed) > 0) fail();  // another thread has seen it
        if (found > next_.load(std::memory_order_relaxed)) look(found);
    }

   private:
    void look(std::int64_t found) {
        if (!counted_.exchange(true))
            require(count_duplicates(call_.scene, call_.query, call_.rule, call_.levels, &meter_));
        require(found);
        const std::int64_t none = bytes(0);
        next_.store((meter_.limit - none) / (bytes(1) - none), std::memory_order_relaxed);
    }
    void require(std::int64_t pairs) {
        if (bytes(pairs) <= meter_.limit) return;
        least_.store(bytes(pairs), std::memory_order_relaxed);
        fail();
    }
    [[noreturn]] void fail() const { throw ResultExceeds{{least_.load(std::memory_order_relaxed)}}; }
    std::int64_t bytes(std::int64_t pairs) const {
        constexpr std::int64_t most = std::int64_t{1} << 54;  // more would overflow, and is no use
        return result_bytes(call_.scene, call_.query, std::min(pairs, most));
    }

    const Call call_;
    MemoryMeter& meter_;
    std::atomic<std::int64_t> found_{0}, next_;
    std::atomic<std::int64_t> least_{0};  ///< bytes that are needed, once they are more than the limit
    std::atomic<bool> counted_{false};
};

}  // namespace crumple
