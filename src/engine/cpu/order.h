#pragma once

// The order of the stages: [MZ] Algorithm 1.

#include "engine/cpu/buffers.h"
#include "engine/cpu/pair_range.h"
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

    bool frugal = false;                  ///< one cluster after another, on one worker
    const PairRange* range = nullptr;     ///< only pairs of these ids; null: all
    const PairSink* sink = nullptr;       ///< see NarrowContext
    std::atomic<bool>* enough = nullptr;  ///< see NarrowContext

    PairBudget::Call asked() const { return {scene, query, buffers.rule, levels}; }
};

/// Stage `bounds`, once a call.
void measure(const Call& call);

/// From `subdivide` to `narrow`, on a scene that was measured. Pairs gather in the workers' buffers, unless the sink
/// takes them; of copies of a triangle only the first is there.
void search(const Call& call);

/// Stage `output`: the result from the pairs in the workers' buffers.
void write_result(const Call& call, Collisions& result);

/// What belongs to the pairs of `result`: where they meet, if that is asked for.
void write_contacts(const Call& call, Collisions& result);

/// All stages.
void find(const Call& call, Collisions& result);

/// Whether there is any pair; ends at the first.
bool any(Call call);

}  // namespace crumple::cpu
