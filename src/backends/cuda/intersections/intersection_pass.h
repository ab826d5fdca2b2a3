#pragma once

// Pass of an intersection query: adds its records to `sort`, the plane filter to `sweep`, then `narrow`.

#include "backends/cuda/intersections/intersection_narrow.h"
#include "backends/cuda/stages/pass.h"

namespace crumple::cuda {

class IntersectionPass : public Pass {
   public:
    using Pass::Pass;

    NarrowPolicy policy;

    void cut(ArenaLayout& cutter) override;
    void sort() override { sort_by(StaticTriangle{}, records_); }
    void sweep(const Slice& slice) override { sweep_by(slice, PlaneTest{records_.record, policy}); }
    void narrow(const Hits& hits);

    List<Hit> hits() const { return {hits_, &counters->hits, plan.hits}; }
    Pair* beyond() const { return beyond_; }

   protected:  // accessed by tests of the stages
    RecordRows records_{};
    Candidate* undecided_ = nullptr;
    Pair* beyond_ = nullptr;
    Hit* hits_ = nullptr;
};

}  // namespace crumple::cuda
