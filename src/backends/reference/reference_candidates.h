#pragma once

// Candidates by brute force: the boxes of all pairs of features, compared in rational numbers. Features are listed here
// anew. One thread, O(features²).

#include "base/cancellation.h"
#include "queries/candidate_request.h"

namespace crumple {

/// Takes a row.
using CandidateSink = FunctionRef<void(CandidateKind kind, const Pair& pair)>;

/// `sink`: takes each row, in the order of the result.
void find_candidates_by_brute_force(const PreparedScene& scene, const CandidateRequest& query,
                                    Cancellation& cancellation, CandidateSink sink);

}  // namespace crumple
