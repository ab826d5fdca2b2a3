#pragma once

// One scene searched for pairs of features that touch or are near.

#include <optional>
#include <vector>

#include "engine/cuda/finder.h"
#include "engine/feature_query.h"
#include "questions/features/cuda/input.h"
#include "questions/features/cuda/output.h"
#include "questions/features/cuda/pass.h"

namespace crumple::cuda {

class FeatureFinder : Finder<FeaturePass> {
   public:
    FeatureFinder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                  MemoryMeter& meter, Cancellation& cancellation, Input& input, FeaturesOnDevice& features)
        : Finder(device, geometry, stream, options, meter, cancellation, input), features_(stream, meter, features) {}

    /// Of a scene in host memory.
    void find(const Scene& scene, const FeatureQuery& query, FeatureAnswer& answer);

    /// Gives back all that is kept between calls.
    void release();

   private:
    /// What the plan was made for. Questions that take turns keep it, and lists suit the longest.
    struct SceneKind {
        std::int64_t triangles = -1;
        bool all_kinds = false;
        friend bool operator==(const SceneKind&, const SceneKind&) = default;
    };
    /// What sizes and places of all arrays follow from.
    struct Layout {
        std::int64_t vertices, triangles;
        bool float32, moving;
        Plan plan;
        FirstOfKind firsts;
        Extent extent;
        friend bool operator==(const Layout&, const Layout&) = default;
    };

    void adopt(const Scene& scene, const FeatureQuery& query);
    void plan();
    void lay_out_lists();
    void find_at_once(FeatureAnswer& answer);
    void enqueue();
    FeatureHits hits() const;
    bool accept();
    std::vector<RankedHit> decide_beyond(std::size_t count);
    void write_again(const std::vector<RankedHit>& found, unsigned long long before);
    void copy_to(FeatureAnswer& answer);
    void tell_earliest(FeatureAnswer& answer);

    void find_in_chunks(FeatureAnswer& answer, Lists lists);
    bool take_slice(Array<RankedHit>& found, FeatureAnswer& answer);
    void write_sorted(Array<RankedHit>& found, FeatureAnswer& answer) const;

    FeatureInput features_;
    FeatureOutput output_{};
    Earliest* earliest_ = nullptr;
    const FeatureQuery* query_ = nullptr;  // of the call
    std::optional<Layout> laid_out_;
    SceneKind planned_for_;
};

}  // namespace crumple::cuda
