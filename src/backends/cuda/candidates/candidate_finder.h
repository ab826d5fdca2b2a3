#pragma once

// One scene searched for pairs of features whose inflated boxes overlap.

#include <array>

#include "backends/cuda/candidates/candidate_pass.h"
#include "backends/cuda/engine/finder.h"
#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "queries/candidate_request.h"
#include "queries/device_answer.h"

namespace crumple::cuda {

/// Per-slot state of queries for candidates.
struct CandidateSlot {
    explicit CandidateSlot(MemoryMeter& meter) : values(meter), host(&meter) {}

    Block values;
    Inflation* widening = nullptr;
    Normaliser* normaliser = nullptr;
    AskedOfCandidates asked;
    FirstOfCandidates firsts;
    CandidateOutput output{};
    // What accepting has found:
    ListEnds<candidate_kinds> ends;
    CandidateAnswer host;  ///< the lists, if they were found in chunks
};

/// Its calls are those of FeatureFinder.
class CandidateFinder final : public Finder {
   public:
    CandidateFinder(BackendState& state, FeaturesOnDevice& features);

    void bring(std::size_t slot, const PreparedScene& scene, const CandidateRequest& query);
    void view(std::size_t slot, const Shape& shape, const CandidateRequest& query, Room room = Room::grows);
    void copy_to(CandidateAnswer& answer);
    DeviceAnswer show();
    DeviceAnswer show_incomplete() const { return incomplete_answer(*slot().counters); }

    void release() override;

   private:
    CandidateSlot& own() { return own_[current()]; }
    const CandidateSlot& own() const { return own_[current()]; }
    void adopt(const CandidateRequest& query, Room room);
    CandidateHits hits() const;
    void take_hits(Array<RankedCandidate>& found);
    void write_sorted(Array<RankedCandidate>& found);
    void upload();

    void bind() override;
    KernelParameters parameters() const override { return CandidateParameters{own().asked, own().firsts}; }
    void choose_plan(Plan& plan) const override;
    void choose_chunks(Plan& plan, std::int64_t bytes) const override;
    void cut_rows(Cutter& cutter) override;
    void clear_rows(Clearing& clearing) const override;
    void make_ready() override;
    void narrow() override;
    bool write_rows(Counters* host_counters) override;
    void count_tests(const Counters& counters, Statistics& statistics) const override;
    void read_rows(unsigned long long total) override;
    void find_in_chunks() override;

    FeaturesOnDevice& features_;
    CandidatePass pass_;
    std::array<CandidateSlot, Flights::slots> own_;
};

}  // namespace crumple::cuda
