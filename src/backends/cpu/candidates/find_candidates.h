#pragma once

// The stages in the service of candidates: which features have grown boxes that overlap.

#include "backends/cpu/candidates/candidate_leaves.h"
#include "backends/cpu/order.h"
#include "backends/cpu/stages/sort_pairs.h"

namespace crumple::cpu {

/// What is kept from call to call, beside the stages' buffers.
struct CandidateBuffers {
    CandidateBuffers(MemoryMeter* m, int workers, const CandidateKernels& kernels)
        : leaves(m, workers, kernels), sorting(m), offsets(m) {}
    CandidateLeaves leaves;
    // Of `output`:
    PairSorting sorting;
    Array<std::int64_t> offsets;
};

/// By how much the boxes of triangles are widened, in the normalised coordinates of the scene: rounded up, and at most
/// what holds everything.
Inflation inflation_of(const PreparedScene& scene, const CandidateRequest& query);

/// All stages; call.question is that of the buffers.
void find(const Call& call, const CandidateRequest& query, CandidateBuffers& buffers, CandidateAnswer& answer);

/// All stages but `output`: gives all candidates to a stream.
void stream(Call call, const CandidateRequest& query, CandidateBuffers& buffers, CandidateStream& to);

}  // namespace crumple::cpu
