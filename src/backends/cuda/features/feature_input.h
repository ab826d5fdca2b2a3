#pragma once

// Input of feature queries on the device, beside the scene: tables of the features that each triangle owns, radii, the
// rest shape, and rings of adjacent vertices.

#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/device/launch_queue.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/features/feature_narrow.h"
#include "backends/cuda/input/cached_mesh.h"
#include "backends/cuda/stages/bounds.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// Device copies of a scene's features and vertex rings, cached while these stay the same.
class FeaturesOnDevice {
   public:
    FeaturesOnDevice(cudaStream_t stream, MemoryMeter& meter, const LaunchQueue& launches_in_flight)
        : stream_(stream), launches_in_flight_(launches_in_flight), block_(meter), rings_(meter) {}

    /// Uploads the host's features or rings unless they are the cached ones. The upload is complete on return; the
    /// returned table is valid until the next call. If the cached ones have to be replaced, waits for passes in flight,
    /// or throws CapacityError for Growth::fixed.
    const FeatureTable& bring(const SceneFeatures& features, std::int64_t vertices, Growth growth = Growth::grows);
    RingTable bring(const VertexRings* rings, Growth growth = Growth::grows);
    /// Returns the topology of the mesh whose features were uploaded last.
    const CachedMesh& known() const { return known_; }
    void release();

   private:
    void replace(Growth growth) const;

    cudaStream_t stream_;
    const LaunchQueue& launches_in_flight_;
    Block block_, rings_;
    FeatureTable table_;
    CachedMesh known_;
    RingTable ring_table_;
    std::uint64_t rings_revision_ = 0;
};

/// Returns the joint numbering of the features that come first in a pair, for the kinds that the request lists. Throws
/// Error if there are too many.
FirstOfKind firsts_of(const FeatureRequest& query);

/// Kernel parameters that are part of a graph's key (engine/graph_key.h).
struct FeatureParameters {
    FeatureConditions asked;
    VertexReader rest;  ///< the caller's rest shape, if it lies on the device
    FirstOfKind firsts;
    Extent extent;
    bool all_kinds;
    friend bool operator==(const FeatureParameters&, const FeatureParameters&) = default;
    void forget_places() {
        asked.forget_places();
        forget_place(rest.data);
        firsts = {};
    }
};

/// Input of a feature query that may change in each call: radii, rest positions and inflation.
class FeatureInput {
   public:
    FeatureInput(cudaStream_t stream, MemoryMeter& meter) : stream_(stream), block_(meter), rest_(&meter) {}

    /// Uploads the input from the host; complete on return.
    void bring(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features);
    /// Binds radii and a rest shape that the caller has on the device.
    void view(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features, Growth growth);

    /// Enqueues the work that each pass does after the scene's box has been computed: checks the radii and rest
    /// positions that the caller has on the device, normalises radii, and computes the inflation.
    void enqueue(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const SceneBox* box,
                 Counters* counters) const;

    FeatureParameters parameters(Extent extent) const { return {asked_, given_rest_, firsts_, extent, all_kinds_}; }
    const FeatureConditions& asked() const { return asked_; }
    const FirstOfKind& firsts() const { return firsts_; }
    bool all_kinds() const { return all_kinds_; }

    void release();

   private:
    void place_values(const PreparedScene& scene, const FeatureRequest& query, bool viewed, Growth growth);
    void tell(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features, Growth growth);

    cudaStream_t stream_;
    Block block_;
    Array<double> rest_;       ///< rest positions, staged for the upload
    VertexReader given_rest_;  ///< rest positions on the device, from view()
    bool viewed_ = false;
    FeatureConditions asked_;
    FirstOfKind firsts_;
    bool all_kinds_ = false;
    Inflation* inflation_ = nullptr;
    float *vertex_radius_ = nullptr, *triangle_radius_ = nullptr;
    double *radius_ = nullptr, *resting_ = nullptr;
    std::int32_t* bodies_ = nullptr;
};

}  // namespace crumple::cuda
