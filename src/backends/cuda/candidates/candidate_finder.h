#pragma once

// Search of one scene for pairs of features whose inflated boxes overlap.

#include <array>

#include "backends/cuda/candidates/candidate_pass.h"
#include "backends/cuda/features/row_finder.h"

namespace crumple::cuda {

/// State of one slot for candidates, in addition to RowSlot.
struct CandidateSlot {
    explicit CandidateSlot(MemoryMeter& meter) : values(meter) {}

    Block values;
    Inflation* widening = nullptr;
    Normaliser* normaliser = nullptr;
    CandidateConditions asked;
    FirstOfKind firsts;
    CandidateOutput output{};
};

class CandidateFinder final : public RowFinder {
   public:
    CandidateFinder(BackendState& state, FeaturesOnDevice& features);

    void release() override;

   private:
    CandidateSlot& own() { return own_[current()]; }
    const CandidateSlot& own() const { return own_[current()]; }
    CandidateHits hits() const;
    void download_hits(Array<RankedCandidate>& found);

    void upload_request(const FeatureRequest& request, bool viewed, Growth growth) override;
    RowsByKind& rows() override { return own().output; }
    void bind() override;
    KernelParameters parameters() const override { return CandidateParameters{own().asked, own().firsts}; }
    void choose_plan(Plan& plan) const override;
    void choose_chunks(Plan& plan, std::int64_t bytes) const override;
    void cut_rows(ArenaLayout& cutter) override;
    void clear_rows(BatchedClear& batch) const override;
    void make_ready() override;
    void narrow() override;
    bool write_rows(Counters* host_counters) override;
    void find_in_chunks() override;

    CandidatePass pass_;
    std::array<CandidateSlot, LaunchQueue::slots> own_;
};

}  // namespace crumple::cuda
