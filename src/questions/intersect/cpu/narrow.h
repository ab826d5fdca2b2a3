#pragma once

// Stages `sweep` and `narrow` of one sorted leaf: candidates are swept in chunks (engine/cpu/sweep.h), and each chunk
// is filtered, then decided, while it is still in the cache.

#include <atomic>
#include <functional>

#include "base/cancellation.h"
#include "crumple/collisions.h"
#include "engine/cpu/ownership.h"
#include "engine/cpu/sweep.h"
#include "engine/pair_budget.h"
#include "model/rules.h"
#include "questions/intersect/cpu/records.h"
#include "questions/intersect/decide.h"

namespace crumple::cpu {

/// What narrow needs to know about the call.
struct NarrowContext {
    const Scene& scene;
    const Query& query;
    const GroupRule& rule;
    const StageKernels& stages;
    const IntersectKernels& kernels;
    PointRows points;
    Cancellation& cancellation;
    std::atomic<bool>* found = nullptr;  ///< not null: set, and everybody stops, as soon as a worker has found a pair
    /// Takes the pairs of each chunk instead of letting them gather in NarrowScratch::pairs; null: they gather.
    const std::function<void(const Array<Pair>&)>* sink = nullptr;
    PairBudget* budget = nullptr;  ///< told of the pairs; null: there is no limit

    /// Asked before each chunk. Throws if the call was cancelled.
    bool stop() const {
        cancellation.check();
        return found && found->load(std::memory_order_relaxed);
    }
};

/// Scratch and findings of one worker.
struct NarrowScratch {
    explicit NarrowScratch(MemoryMeter* m) : candidates(m), verdicts(m), pairs(m) {}
    Candidates candidates;
    Verdicts verdicts;
    Array<Pair> pairs;      ///< joint numbering, lower id first
    Statistics statistics;  ///< counts and times of sweep and narrow

    std::int64_t most_candidates = 0;  ///< of all chunks so far
};

/// Sweeps rows [first, last) of a leaf and appends the colliding pairs that the leaf owns.
void sweep_and_narrow(const NarrowContext& context, const SortedLeaf& leaf, const LeafRecords& records,
                      const Ownership& ownership, std::int64_t first, std::int64_t last, NarrowScratch& scratch);

}  // namespace crumple::cpu
