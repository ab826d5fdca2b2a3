#pragma once

// Runs the stages for requests about features: which touch in a step, are near, or have boxes that overlap.

#include <span>

#include "backends/cpu/candidates/find_candidates.h"
#include "backends/cpu/features/feature_leaves.h"
#include "backends/cpu/order.h"

namespace crumple::cpu {

/// Memory that calls reuse, in addition to the stages' buffers.
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
    // For stage `output`, except that of candidates:
    Array<std::int64_t> place;  ///< by first feature: its first row; then the number of rows
    Array<FeatureHit> placed;   ///< rows, grouped by first feature
};

/// Returns the inflation of triangles in the normalised coordinates of the scene: rounded up, and capped at a length
/// that covers the whole scene.
Inflation inflation_of(const PreparedScene& scene, const FeatureRequest& query);

/// Returns the inflation if each vertex has a radius. It points to radii of triangles in `buffers`, which must stay
/// valid.
Inflation inflation_of_radii(const PreparedScene& scene, std::span<const double> radii, Workers& workers,
                             FeatureBuffers& buffers);

/// Returns the LeafQuery in `buffers` that serves the request, for Call::query.
LeafQuery& leaves_of(const PreparedScene& scene, const FeatureRequest& query, FeatureBuffers& buffers);

/// Runs all stages. call.query must be the result of leaves_of().
void find(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureResult& result);

/// Runs all stages but `output`, and delivers all rows to a stream.
void stream(Call call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureStream& to);

}  // namespace crumple::cpu
