#pragma once

// The order of the stages: [MZ] Algorithm 1.

#include <functional>

#include "engine/cpu/buffers.h"
#include "engine/cpu/parallel.h"
#include "engine/pair_budget.h"
#include "model/levels.h"

namespace crumple::cpu {

/// What is asked, who answers, and where the pairs go.
struct Call {
    const Scene& scene;
    const Query& query;
    Levels levels;  ///< above the scene
    const Options& options;
    const StageKernels& kernels;
    const IntersectKernels& intersect;
    Workers& workers;
    ParallelFor& parallel;  ///< the same workers, for the model
    Cancellation& cancellation;
    MemoryMeter& meter;
    Buffers& buffers;
    Statistics& statistics;

    bool frugal = false;                                            ///< one cluster after another, on one worker
    std::atomic<bool>* found = nullptr;                             ///< see NarrowContext
    const std::function<void(const Array<Pair>&)>* sink = nullptr;  ///< see NarrowContext
    PairBudget* budget = nullptr;                                   ///< see NarrowContext

    PairBudget::Call asked() const { return {scene, query, buffers.rule, levels}; }
};

/// All stages but the last. Pairs go to the sink, or gather in the workers' buffers; of copies of a triangle only the
/// first is there.
void find_pairs(const Call& call);

/// All stages.
void find(const Call& call, Collisions& result);

/// What belongs to the pairs of `result`: where they meet, if that is asked for.
void write_contacts(const Call& call, Collisions& result);

}  // namespace crumple::cpu
