#pragma once

// Runs the stages for candidate queries; find_features.cpp calls this.

#include "backends/cpu/candidates/candidate_leaves.h"
#include "backends/cpu/order.h"
#include "backends/cpu/stages/sort_pairs.h"

namespace crumple::cpu {

/// Memory that calls reuse, in addition to the stages' buffers.
struct CandidateBuffers {
    CandidateBuffers(MemoryMeter* m, int workers, const CandidateKernels& kernels)
        : leaves(m, workers, kernels), sorting(m), offsets(m) {}
    CandidateLeaves leaves;
    // For stage `output`:
    PairSorting sorting;
    Array<std::int64_t> offsets;
};

/// Runs the stages from `subdivide` to `narrow`, and finds the pairs of features that one triangle owns. `leaves` keeps
/// the results.
void search_candidates(const Call& call, const FeatureRequest& query, CandidateLeaves& leaves);

/// Runs stage `output`.
void write_candidates(const Call& call, const FeatureRequest& query, CandidateBuffers& buffers, FeatureResult& result);

}  // namespace crumple::cpu
