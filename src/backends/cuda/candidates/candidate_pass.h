#pragma once

// Pass of a candidate query: adds its records to `sort`, then finds pairs of features.

#include "backends/cuda/candidates/candidate_narrow.h"
#include "backends/cuda/stages/pass.h"

namespace crumple::cuda {

class CandidatePass : public Pass {
   public:
    using Pass::Pass;

    CandidateConditions asked;

    void cut(ArenaLayout& c) override {
        Pass::cut(c);
        rows_ = c.take<CandidateMember>(plan.last_members());
        hits_ = c.take<RankedCandidate>(plan.hits);
    }

    // In a static scene Primitives::ends is 0, so end positions are those of the start.
    void sort() override { sort_by(Widened<2>{primitives.ends, primitives.inflation}, CandidateMembers{rows_, asked}); }
    void sweep(const Slice& slice) override { sweep_by(slice, OverlapAlone{}); }
    void narrow(const CandidateHits& hits) {
        find_candidates(geometry_, stream_, asked, rows_, survivors(), hits, counters);
    }
    void search_within(const CandidateHits& hits) { find_within(geometry_, stream_, scene, wanted, asked, hits); }

    List<RankedCandidate> hits() const { return {hits_, &counters->hits, plan.hits}; }

   private:
    CandidateMember* rows_ = nullptr;
    RankedCandidate* hits_ = nullptr;
};

}  // namespace crumple::cuda
