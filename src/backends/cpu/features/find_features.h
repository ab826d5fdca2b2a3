#pragma once

// The stages in the service of questions about features: what touches what in a step, what is near what.

#include <span>

#include "backends/cpu/features/feature_leaves.h"
#include "backends/cpu/order.h"

namespace crumple::cpu {

/// What is kept from call to call, beside the stages' buffers.
struct FeatureBuffers {
    FeatureBuffers(MemoryMeter* m, int workers, const FeatureTables& kernels)
        : at_rest(m, workers, kernels),
          moving(m, workers, kernels),
          vertex_radius(m),
          triangle_radius(m),
          place(m),
          placed(m) {}
    FeatureLeaves<1> at_rest;
    FeatureLeaves<2> moving;
    Array<float> vertex_radius, triangle_radius;  ///< FeatureRequest::radii in normalised coordinates, rounded up
    // Of `output`:
    Array<std::int64_t> place;  ///< of the rows of each first feature
    Array<FeatureHit> placed;
};

/// How much `query` asks for in the normalised coordinates of the scene: rounded up, and at most what holds everything.
Inflation inflation_of(const PreparedScene& scene, const FeatureRequest& query);

/// The same where each vertex has a radius; of each triangle that is in the buffers, which are to stay.
Inflation inflation_of_radii(const PreparedScene& scene, std::span<const double> radii, Workers& workers,
                             FeatureBuffers& buffers);

/// Calls work(leaves) with the scene's, which are told what is asked.
template <class Work>
void with_leaves(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, Work work) {
    const auto ask = [&](auto& leaves) {
        leaves.ask(query, 2 * call.inflation.half, query.radii.empty() ? nullptr : buffers.vertex_radius.data());
        work(leaves);
    };
    if (call.scene.moving)
        ask(buffers.moving);
    else
        ask(buffers.at_rest);
}

/// All stages; call.question is one of the buffers', as the scene moves.
void find(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureAnswer& answer);

/// All stages but `output`: gives all hits to a stream.
void stream(Call call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureStream& to);

}  // namespace crumple::cpu
