#pragma once

// Stages `sweep` and `narrow` of one sorted leaf, a small set of triangles. The sweep finds candidates, pairs of
// triangles whose boxes overlap, in chunks (backends/cpu/stages/sweep.h). Each chunk is filtered, then decided, while
// it is still in the cache.

#include <atomic>

#include "backends/cpu/intersections/intersection_records.h"
#include "backends/cpu/stages/ownership.h"
#include "backends/cpu/stages/sweep.h"
#include "base/cancellation.h"
#include "crumple/function_ref.h"
#include "crumple/intersections.h"
#include "exact/intersection/decide_intersection.h"
#include "scene/scene_filter.h"

namespace crumple::cpu {

struct NarrowScratch;

/// Callback after stage `narrow` of each chunk, on the worker that ran it. `scratch`: that of the worker; its pairs
/// from `before` on are new. The callback may remove pairs from scratch.pairs; the remaining ones accumulate.
using PairSink = FunctionRef<void(NarrowScratch& scratch, std::size_t before)>;

/// Data of the call that `narrow` needs. `rule`: the pair filter.
struct NarrowContext {
    const PreparedScene& scene;
    const IntersectionQuery& query;
    const SceneFilter& rule;
    const StageKernels& stages;
    const IntersectKernels& kernels;
    PointRows points;
    Cancellation& cancellation;
    bool decides = true;                  ///< false: pairs that filters leave undecided count as pairs
    const PairSink* sink = nullptr;       ///< null: pairs accumulate in NarrowScratch::pairs
    std::atomic<bool>* enough = nullptr;  ///< if not null: all workers stop once it is set

    /// Returns true if the search may end. Called before each chunk. Throws if the call was cancelled.
    bool stop() const {
        cancellation.check();
        return enough && enough->load(std::memory_order_relaxed);
    }
};

/// Scratch and results of one worker.
struct NarrowScratch {
    explicit NarrowScratch(MemoryMeter* m) : candidates(m), verdicts(m), pairs(m) {}
    CandidateChunk candidates;
    Verdicts verdicts;
    Array<Pair> pairs;      ///< triangles as numbered in the scene, lower id first
    std::int64_t unit = 0;  ///< unit of a stream (queries/row_stream.h) that the pairs belong to
    Statistics statistics;  ///< counts and times of sweep and narrow

    std::int64_t most_candidates = 0;  ///< largest CandidateChunk::count so far
};

/// Sweeps rows [first, last) of a leaf, and appends the colliding pairs that the leaf owns to scratch.pairs.
void sweep_and_narrow(const NarrowContext& context, const SortedLeaf& leaf, const LeafRecords& records,
                      const Ownership& ownership, std::int64_t first, std::int64_t last, NarrowScratch& scratch);

}  // namespace crumple::cpu
