#pragma once

// The stages in the service of requests about features: which touch in a step, are near, or have boxes that overlap.

#include <span>

#include "backends/cpu/candidates/find_candidates.h"
#include "backends/cpu/features/feature_leaves.h"
#include "backends/cpu/order.h"

namespace crumple::cpu {

/// Kept from call to call, beside the stages' buffers.
struct FeatureBuffers {
    FeatureBuffers(MemoryMeter* m, int workers, const FeatureTables& kernels, const CandidateKernels& candidate_kernels)
        : at_rest(m, workers, kernels),
          moving(m, workers, kernels),
          candidates(m, workers, candidate_kernels),
          vertex_radius(m),
          triangle_radius(m),
          place(m),
          placed(m) {}
    FeatureLeaves<1> at_rest;
    FeatureLeaves<2> moving;
    CandidateBuffers candidates;
    Array<float> vertex_radius, triangle_radius;  ///< FeatureRequest::radii in normalised coordinates, rounded up
    // Members of `output`, but for candidates:
    Array<std::int64_t> place;  ///< of the rows of each first feature
    Array<FeatureHit> placed;
};

/// By how much triangles are widened in the normalised coordinates of the scene: rounded up, and at most what holds
/// everything.
Inflation inflation_of(const PreparedScene& scene, const FeatureRequest& query);

/// The same where each vertex has a radius; of each triangle that is in the buffers, which are to stay.
Inflation inflation_of_radii(const PreparedScene& scene, std::span<const double> radii, Workers& workers,
                             FeatureBuffers& buffers);

/// The leaves of the buffers that a call's `question` is.
LeafQuestion& leaves_of(const PreparedScene& scene, const FeatureRequest& query, FeatureBuffers& buffers);

/// All stages; call.question is leaves_of().
void find(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureResult& result);

/// All stages but `output`: gives all rows to a stream.
void stream(Call call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureStream& to);

}  // namespace crumple::cpu
