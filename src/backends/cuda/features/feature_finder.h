#pragma once

// Search of one scene for impacts or proximities.

#include <array>
#include <vector>

#include "backends/cuda/features/feature_pass.h"
#include "backends/cuda/features/feature_rows.h"
#include "backends/cuda/features/row_finder.h"

namespace crumple::cuda {

/// State of one slot for impacts and near pairs, in addition to RowSlot.
struct FeatureSlot {
    FeatureSlot(cudaStream_t stream, MemoryMeter& meter) : features(stream, meter) {}

    FeatureInput features;
    FeatureOutput output{};
    Earliest* earliest = nullptr;
};

class FeatureFinder final : public RowFinder {
   public:
    FeatureFinder(BackendState& state, FeaturesOnDevice& features);

    void release() override;

   private:
    FeatureSlot& own() { return own_[current()]; }
    const FeatureSlot& own() const { return own_[current()]; }
    const FirstOfKind& firsts() const { return own().features.firsts(); }
    bool is_all_output() const { return request().extent == Extent::all; }
    bool is_first_output() const { return request().extent != Extent::any && request().criterion == Criterion::impact; }
    FeatureHits hits() const;
    void read_earliest();
    bool download_slice(Array<RankedHit>& found);
    void write_sorted(Array<RankedHit>& found);

    void upload_request(const FeatureRequest& request, bool viewed, Growth growth) override;
    RowsByKind& rows() override { return own().output; }
    void bind() override;
    KernelParameters parameters() const override { return own().features.parameters(request().extent); }
    bool all_kinds() const override { return own().features.all_kinds(); }
    void choose_plan(Plan& plan) const override;
    void choose_chunks(Plan& plan, std::int64_t bytes) const override;
    void cut_rows(ArenaLayout& cutter) override;
    void clear_rows(BatchedClear& batch) const override;
    void make_ready() override;
    void narrow() override;
    bool write_rows(Counters* host_counters) override;
    std::size_t decide_unresolved(std::size_t count) override;
    void append_decided(std::size_t count, unsigned long long before) override;
    void read_rows(unsigned long long total) override;
    void find_in_chunks() override;

    FeaturePass pass_;
    std::array<FeatureSlot, LaunchQueue::slots> own_;
    std::vector<RankedHit> decided_;  ///< hits that the host has decided
};

}  // namespace crumple::cuda
