#pragma once

// One scene searched for pairs of features that touch or are near.

#include <optional>
#include <vector>

#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/features/feature_pass.h"
#include "backends/cuda/features/feature_rows.h"
#include "backends/cuda/features/finder.h"
#include "queries/device_answer.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

struct FeatureSlot : FinderSlot {
    FeatureSlot(const Device& device, cudaStream_t stream, MemoryMeter& meter, Input& input)
        : FinderSlot(device, stream, meter, input), features(stream, meter), host(&meter) {}

    /// Keeps what accepting an answer takes; scene, features and rule are the caller's.
    void ask(const FeatureRequest& asked);

    FeatureInput features;
    std::optional<FeatureRequest> query;
    RestShape rest;  ///< the query's
    FeatureOutput output{};
    Earliest* earliest = nullptr;
    // What accepting has found:
    std::array<unsigned long long, feature_kinds + 1> ends{};  ///< of the lists, among all rows
    bool any = false;
    FirstImpact first;
    FeatureAnswer host;  ///< the lists, if they were found in chunks
};

using FeatureKeyOfGraph = FinderKey<AskedOfFeatures, FirstOfKind>;

class FeatureFinder : public Finder<FeatureFinder, FeaturePass, FeatureSlot, FeatureKeyOfGraph> {
    friend Finder;

   public:
    FeatureFinder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                  MemoryMeter& meter, Cancellation& cancellation, Flights& flights,
                  const std::array<Input*, Flights::slots>& inputs, FeaturesOnDevice& features)
        : Finder(device, geometry, stream, options, meter, cancellation, flights, inputs), features_(features) {}

    /// Works on a slot, whose last answer goes, and brings what is asked: of a scene on the host, or of a mesh on the
    /// device whose counts are those of the features.
    void bring(std::size_t slot, const PreparedScene& scene, const FeatureRequest& query);
    void view(std::size_t slot, const Shape& shape, const FeatureRequest& query, Room room = Room::grows);
    void copy_to(FeatureAnswer& answer);
    /// Where the answer lies on the device; brings it there if it does not.
    DeviceAnswer show();

    /// Gives back all that is kept between calls.
    void release();

   private:
    /// What the plan was made for. Questions that take turns keep it, and lists suit the longest.
    struct SceneKind {
        std::int64_t triangles = -1;
        bool all_kinds = false;
        friend bool operator==(const SceneKind&, const SceneKind&) = default;
    };

    const FeatureRequest& query() const { return *slot().query; }
    const FirstOfKind& firsts() const { return slot().features.firsts(); }
    const VertexReader& rest() const { return slot().features.given_rest(); }
    Extent extent() const { return query().extent; }
    bool all_kinds() const { return pass_.all_kinds; }
    void adopt(const FeatureRequest& query);
    void look();
    void plan();
    void cut_answer(Cutter& cutter);
    void enqueue(StageEvents* watch);
    FeatureHits hits() const;
    bool accept();
    std::vector<RankedHit> decide_beyond(std::size_t count);
    void write_again(const std::vector<RankedHit>& found, unsigned long long before);
    void read_answer();
    void read_earliest();
    void upload();

    void find_in_chunks(Lists lists);
    bool take_slice(Array<RankedHit>& found);
    void write_sorted(Array<RankedHit>& found);

    FeaturesOnDevice& features_;
    SceneKind planned_for_;
};

}  // namespace crumple::cuda
