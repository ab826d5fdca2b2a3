#pragma once

// What a question about features brings beside the scene, on the device: which features triangles own, radii, the shape
// at rest, rings of neighbours.

#include "engine/cuda/bounds.h"
#include "engine/cuda/memory.h"
#include "engine/feature_query.h"
#include "questions/features/cuda/narrow.h"

namespace crumple::cuda {

class FeatureInput {
   public:
    FeatureInput(cudaStream_t stream, MemoryMeter& meter)
        : stream_(stream), features_(meter), rings_(meter), values_(meter), rest_(&meter) {}

    /// Copies what the host has; done when it returns. Features and rings only if they are others than those that lie
    /// there. `scene`: of the host.
    void bring(const Scene& scene, const FeatureQuery& query);

    /// Work that each pass begins with, once the scene's box is known.
    void enqueue(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const SceneBox* box) const;

    const AskedOfFeatures& asked() const { return asked_; }
    const FirstOfKind& firsts() const { return firsts_; }
    bool all_kinds() const { return all_kinds_; }

    void release();

   private:
    void bring_features(const SceneFeatures& features, std::int64_t vertices);
    void bring_rings(const VertexRings* rings);
    void bring_values(const Scene& scene, const FeatureQuery& query);

    cudaStream_t stream_;
    Block features_, rings_, values_;
    Array<double> rest_;  ///< positions at rest, on their way to the device
    std::uint64_t features_revision_ = 0, rings_revision_ = 0;
    FeatureTable table_;
    RingTable ring_table_;
    AskedOfFeatures asked_;
    FirstOfKind firsts_;
    bool all_kinds_ = false;
    Inflation* inflation_ = nullptr;
    float *vertex_radius_ = nullptr, *triangle_radius_ = nullptr;
};

}  // namespace crumple::cuda
