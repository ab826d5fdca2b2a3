#pragma once

// Answers about features that exceed memory: handed over in pieces.
//
// In order: as stream_intersections.h does for pairs of triangles, kind by kind. A piece has all rows of a kind whose
// first feature is in a range; what is searched for it are the triangles that own these features, and those that reach
// them. If the whole answer fits a block it is found at once.
//
// As found: all is searched once, and a worker hands over what it has found whenever that is worth a lock.

#include "backends/cpu/candidates/find_candidates.h"
#include "backends/cpu/features/find_features.h"

namespace crumple::cpu {

/// In pieces of at most `most` rows. call.question is one of the buffers'.
void stream_in_order(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, std::int64_t most,
                     FeatureSink sink);
void stream_in_order(const Call& call, const CandidateRequest& query, CandidateBuffers& buffers, std::int64_t most,
                     CandidateSink sink);

/// In any order, by each worker.
void stream_as_found(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureSink sink);
void stream_as_found(const Call& call, const CandidateRequest& query, CandidateBuffers& buffers, CandidateSink sink);

}  // namespace crumple::cpu
