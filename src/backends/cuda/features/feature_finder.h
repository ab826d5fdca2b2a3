#pragma once

// One scene searched for pairs of features that touch or are near.

#include <array>
#include <optional>
#include <vector>

#include "backends/cuda/engine/finder.h"
#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/features/feature_pass.h"
#include "backends/cuda/features/feature_rows.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "queries/device_answer.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// Per-slot state of queries about features.
struct FeatureSlot {
    FeatureSlot(cudaStream_t stream, MemoryMeter& meter) : features(stream, meter), host(&meter) {}

    /// Keeps what accepting a result takes; scene, features and rule are the caller's.
    void ask(const FeatureRequest& asked);

    FeatureInput features;
    std::optional<FeatureRequest> query;
    RestShape rest;  ///< the query's
    FeatureOutput output{};
    Earliest* earliest = nullptr;
    // What accepting has found:
    ListEnds<feature_kinds> ends;
    bool any = false;
    FirstImpact first;
    FeatureAnswer host;  ///< the lists, if they were found in chunks
};

class FeatureFinder final : public Finder {
   public:
    FeatureFinder(BackendState& state, FeaturesOnDevice& features);

    /// Works on a slot, whose last rows go, and brings what is asked: of a scene on the host, or of a mesh on the
    /// device whose counts are those of the features.
    void bring(std::size_t slot, const PreparedScene& scene, const FeatureRequest& query);
    void view(std::size_t slot, const Shape& shape, const FeatureRequest& query, Room room = Room::grows);
    void copy_to(FeatureAnswer& answer);
    /// Where the rows lie on the device; brings them there if they do not.
    DeviceAnswer show();
    /// Result of an incomplete replay.
    DeviceAnswer show_incomplete() const { return incomplete_answer(*slot().counters); }

    void release() override;

   private:
    FeatureSlot& own() { return own_[current()]; }
    const FeatureSlot& own() const { return own_[current()]; }
    const FeatureRequest& query() const { return *own().query; }
    const FirstOfKind& firsts() const { return own().features.firsts(); }
    bool wants_all() const { return query().extent == Extent::all; }
    bool wants_earliest() const { return query().extent != Extent::any && query().motion; }
    void adopt(const FeatureRequest& query);
    FeatureHits hits() const;
    void read_earliest();
    void upload();
    bool take_slice(Array<RankedHit>& found);
    void write_sorted(Array<RankedHit>& found);

    void bind() override;
    KernelParameters parameters() const override { return own().features.parameters(query().extent); }
    bool all_kinds() const override { return own().features.all_kinds(); }
    bool wants_any() const override { return query().extent == Extent::any; }
    void choose_plan(Plan& plan) const override;
    void choose_chunks(Plan& plan, std::int64_t bytes) const override;
    void cut_rows(Cutter& cutter) override;
    void clear_rows(Clearing& clearing) const override;
    void make_ready() override;
    void narrow() override;
    bool write_rows(Counters* host_counters) override;
    void count_tests(const Counters& counters, Statistics& statistics) const override;
    std::size_t decide_beyond(std::size_t count) override;
    void append_decided(std::size_t count, unsigned long long before) override;
    void read_rows(unsigned long long total) override;
    void find_in_chunks() override;

    FeaturesOnDevice& features_;
    FeaturePass pass_;
    std::array<FeatureSlot, Flights::slots> own_;
    std::vector<RankedHit> decided_;  ///< by the host
};

}  // namespace crumple::cuda
