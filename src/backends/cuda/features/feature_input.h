#pragma once

// What a question about features brings beside the scene, on the device: which features triangles own, radii, the shape
// at rest, rings of neighbours.

#include "backends/cuda/device/flights.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/features/feature_narrow.h"
#include "backends/cuda/input/known_mesh.h"
#include "backends/cuda/stages/bounds.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// The features of a scene, and rings of neighbours, kept on the device while they stay the same.
class FeaturesOnDevice {
   public:
    FeaturesOnDevice(cudaStream_t stream, MemoryMeter& meter, const Flights& flights)
        : stream_(stream), flights_(flights), block_(meter), rings_(meter) {}

    /// Of the host's; done when it returns. Valid until the next call. Where they are others than those that lie here,
    /// passes in flight are waited for, or NoRoom is thrown.
    const FeatureTable& bring(const SceneFeatures& features, std::int64_t vertices, Room room = Room::grows);
    RingTable bring(const VertexRings* rings, Room room = Room::grows);
    /// What bring() was given, of a mesh by itself.
    const KnownMesh& known() const { return known_; }
    void release();

   private:
    void replace(Room room) const;

    cudaStream_t stream_;
    const Flights& flights_;
    Block block_, rings_;
    FeatureTable table_;
    KnownMesh known_;
    RingTable ring_table_;
    std::uint64_t rings_revision_ = 0;
};

/// Joint numbers of what the request lists. Throws Error if there are too many.
FirstOfKind firsts_of(const FeatureRequest& query);

/// Parameters of kernels that a graph is known by (engine/graph_key.h).
struct FeatureParameters {
    AskedOfFeatures asked;
    VertexReader rest;  ///< the shape at rest that lies on the device
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

/// What may be another in each call.
class FeatureInput {
   public:
    FeatureInput(cudaStream_t stream, MemoryMeter& meter) : stream_(stream), block_(meter), rest_(&meter) {}

    /// Copies what the host has; done when it returns.
    void bring(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features);
    /// The same where radii and the shape at rest lie on the device, as the caller gave them.
    void view(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features, Room room);

    /// Work that each pass begins with, once the scene's box is known.
    void enqueue(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const SceneBox* box,
                 Counters* counters) const;

    FeatureParameters parameters(Extent extent) const { return {asked_, given_rest_, firsts_, extent, all_kinds_}; }
    const AskedOfFeatures& asked() const { return asked_; }
    const FirstOfKind& firsts() const { return firsts_; }
    bool all_kinds() const { return all_kinds_; }

    void release();

   private:
    void lay_out_values(const PreparedScene& scene, const FeatureRequest& query, bool viewed, Room room);
    void tell(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features, Room room);

    cudaStream_t stream_;
    Block block_;
    Array<double> rest_;       ///< positions at rest, on their way to the device
    VertexReader given_rest_;  ///< those that view() was given on the device
    bool viewed_ = false;
    AskedOfFeatures asked_;
    FirstOfKind firsts_;
    bool all_kinds_ = false;
    Inflation* inflation_ = nullptr;
    float *vertex_radius_ = nullptr, *triangle_radius_ = nullptr;
    double *radius_ = nullptr, *resting_ = nullptr;
    std::int32_t* bodies_ = nullptr;
};

}  // namespace crumple::cuda
