#pragma once

// The stages in the service of candidates: which features have grown boxes that overlap.

#include "backends/cpu/candidates/candidate_leaves.h"
#include "backends/cpu/order.h"
#include "backends/cpu/stages/sort_pairs.h"

namespace crumple::cpu {

/// What is kept from call to call, beside the stages' buffers.
struct CandidateBuffers {
    CandidateBuffers(MemoryMeter* m, int workers, const CandidateKernels& kernels)
        : leaves(m, workers, kernels), sorting(m), offsets(m), sorted(m) {}
    CandidateLeaves leaves;
    // Of `output`:
    PairSorting sorting;
    Array<std::int64_t> offsets;
    Array<Pair> sorted;  ///< those of a block
};

/// By how much the boxes of triangles are widened, in the normalised coordinates of the scene: rounded up, and at most
/// what holds everything.
Inflation inflation_of(const PreparedScene& scene, const CandidateRequest& query);

/// From `subdivide` to `narrow`, and pairs of features that one triangle owns. The leaves keep what is found.
void search_candidates(const Call& call, const CandidateRequest& query, CandidateLeaves& leaves);

/// Stage `output` of one kind.
void sort_candidates(const Call& call, const CandidateRequest& query, CandidateKind kind, CandidateBuffers& buffers,
                     Array<Pair>& pairs);

/// All stages; call.question is that of the buffers.
void find(const Call& call, const CandidateRequest& query, CandidateBuffers& buffers, CandidateAnswer& answer);

}  // namespace crumple::cpu
