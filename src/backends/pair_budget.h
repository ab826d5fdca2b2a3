#pragma once

// Early end of a call that counts pairs: it throws as soon as the memory limit is certain not to suffice for them.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>

#include "results/intersection_output.h"

namespace crumple {

/// Thrown if the result alone exceeds the limit, so that a search that takes less memory would not help.
struct ResultExceeds : MemoryMeter::Exceeded {};

class PairBudget {
   public:
    PairBudget(const PreparedScene& scene, const IntersectionQuery& query, const MemoryMeter& meter)
        : scene_(scene), query_(query) {
        const std::int64_t none = result_bytes(scene, query, 0);
        if (meter.limit > 0)
            most_pairs_ = std::max<std::int64_t>((meter.limit - none) / (result_bytes(scene, query, 1) - none), 0);
    }

    /// Counts newly found pairs. Thread-safe. Throws ResultExceeds if a result with all pairs so far would exceed the
    /// limit, with the bytes of that result.
    void add(std::int64_t pairs) {
        const std::int64_t found = found_.fetch_add(pairs, std::memory_order_relaxed) + pairs;
        if (found > most_pairs_) throw ResultExceeds{{result_bytes(scene_, query_, std::min(found, most))}};
    }

   private:
    static constexpr std::int64_t most = std::int64_t{1} << 54;  // cap on pairs, so that their bytes do not overflow

    const PreparedScene& scene_;
    const IntersectionQuery& query_;
    /// Number of pairs whose result fits the limit.
    std::int64_t most_pairs_ = std::numeric_limits<std::int64_t>::max();
    std::atomic<std::int64_t> found_{0};
};

}  // namespace crumple
