#pragma once

// What a question about features brings beside the scene, on the device: which features triangles own, radii, the shape
// at rest, rings of neighbours.

#include "engine/cuda/bounds.h"
#include "engine/cuda/memory.h"
#include "engine/feature_query.h"
#include "questions/features/cuda/narrow.h"

namespace crumple::cuda {

/// The features of a scene, kept on the device while they stay the same.
class FeaturesOnDevice {
   public:
    FeaturesOnDevice(cudaStream_t stream, MemoryMeter& meter) : stream_(stream), block_(meter) {}

    /// Of the host's; done when it returns. Valid until the next call.
    const FeatureTable& bring(const SceneFeatures& features, std::int64_t vertices);
    void release() { block_.release(); }

   private:
    cudaStream_t stream_;
    Block block_;
    std::uint64_t revision_ = 0;
    FeatureTable table_;
};

/// Throws Error if so many features are more than joint numbering has.
void check_joint_number(std::int64_t features);

class FeatureInput {
   public:
    FeatureInput(cudaStream_t stream, MemoryMeter& meter, FeaturesOnDevice& features)
        : stream_(stream), features_(features), rings_(meter), values_(meter), rest_(&meter) {}

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
    void bring_rings(const VertexRings* rings);
    void bring_values(const Scene& scene, const FeatureQuery& query);

    cudaStream_t stream_;
    FeaturesOnDevice& features_;
    Block rings_, values_;
    Array<double> rest_;  ///< positions at rest, on their way to the device
    std::uint64_t rings_revision_ = 0;
    RingTable ring_table_;
    AskedOfFeatures asked_;
    FirstOfKind firsts_;
    bool all_kinds_ = false;
    Inflation* inflation_ = nullptr;
    float *vertex_radius_ = nullptr, *triangle_radius_ = nullptr;
};

}  // namespace crumple::cuda
