#pragma once

// The stages in the service of candidates, which find_features.h dispatches to.

#include "backends/cpu/candidates/candidate_leaves.h"
#include "backends/cpu/order.h"
#include "backends/cpu/stages/sort_pairs.h"

namespace crumple::cpu {

/// Kept from call to call, beside the stages' buffers.
struct CandidateBuffers {
    CandidateBuffers(MemoryMeter* m, int workers, const CandidateKernels& kernels)
        : leaves(m, workers, kernels), sorting(m), offsets(m) {}
    CandidateLeaves leaves;
    // Of `output`:
    PairSorting sorting;
    Array<std::int64_t> offsets;
};

/// From `subdivide` to `narrow`, and pairs of features that one triangle owns. The leaves keep them.
void search_candidates(const Call& call, const FeatureRequest& query, CandidateLeaves& leaves);

/// Stage `output`.
void write_candidates(const Call& call, const FeatureRequest& query, CandidateBuffers& buffers, FeatureResult& result);

}  // namespace crumple::cpu
