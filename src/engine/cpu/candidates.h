#pragma once

// The stages in the service of candidates: which features have grown boxes that overlap.

#include "engine/cpu/order.h"
#include "engine/cpu/sort_pairs.h"
#include "questions/candidates/cpu/leaves.h"

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
Inflation inflation_of(const Scene& scene, const CandidateQuery& query);

/// All stages; call.question is that of the buffers.
void find(const Call& call, const CandidateQuery& query, CandidateBuffers& buffers, CandidateAnswer& answer);

}  // namespace crumple::cpu
