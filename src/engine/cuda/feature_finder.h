#pragma once

// One scene searched for pairs of features: planned, passed over, and passed over again where a list was too short, as
// search.h has it for triangles. Where that does not fit the memory limit or the device, clusters are done one after
// another, in slices, and what each finds is brought to the host.

#include <limits>
#include <optional>
#include <vector>

#include "base/cancellation.h"
#include "engine/cuda/input.h"
#include "engine/feature_query.h"
#include "questions/features/cuda/input.h"
#include "questions/features/cuda/output.h"
#include "questions/features/cuda/pass.h"

namespace crumple::cuda {

class FeatureFinder {
   public:
    FeatureFinder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                  MemoryMeter& meter, Cancellation& cancellation, Input& input);

    /// Of a scene in host memory.
    void find(const Scene& scene, const FeatureQuery& query, FeatureAnswer& answer);

    void drop_lists();
    /// The same, and all else that is kept between calls.
    void release();

   private:
    /// What the plan was made for.
    struct SceneKind {
        std::int64_t triangles = -1;
        bool motion = false, all_kinds = false;
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
    void enqueue_until_sorted(Clearing& clearing);
    FeatureHits hits() const;
    bool accept();
    std::vector<RankedHit> decide_beyond(std::size_t count);
    void write_again(const std::vector<RankedHit>& found, unsigned long long before);
    void count(const Counters& counters);
    Counters read_counters();
    void copy_to(FeatureAnswer& answer);
    void tell_earliest(FeatureAnswer& answer);

    enum class Lists : std::uint8_t { shortest, roomy };  ///< of chunks
    void find_in_chunks(FeatureAnswer& answer, Lists lists);
    void lay_out_chunks();
    std::int64_t bytes_left() const;
    void pass_over_slices(Array<RankedHit>& found, FeatureAnswer& answer);
    void write_sorted(Array<RankedHit>& found, FeatureAnswer& answer) const;
    template <class Work>
    static bool fits(Work work);

    const Options& options_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const Geometry& geometry_;
    cudaStream_t stream_;
    Input& input_;
    FeatureInput features_;
    StageEvents watch_;
    Branch beside_;
    Pinned<Counters> counters_;
    Block guides_, work_, answer_;
    FeaturePass pass_;
    FeatureOutput output_{};
    Earliest* earliest_ = nullptr;
    const FeatureQuery* query_ = nullptr;  // of the call
    Statistics statistics_;
    std::optional<Layout> laid_out_;
    SceneKind planned_for_;
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace crumple::cuda
