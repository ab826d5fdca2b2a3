#pragma once

// Pass of a feature query: adds its records to `sort`, its filter by separating directions to `sweep`, then `narrow`.

#include "backends/cuda/features/feature_narrow.h"
#include "backends/cuda/stages/pass.h"

namespace crumple::cuda {

class FeaturePass : public Pass {
   public:
    using Pass::Pass;

    FeatureConditions asked;
    bool all_kinds = false;  ///< true if codimensional edges or points, which the caller lists, need all FeatureKinds

    void cut(ArenaLayout& cutter) override;
    void sort() override;
    void sweep(const Slice& slice) override;
    void narrow(const FeatureHits& hits);

    List<RankedHit> hits() const { return {hits_, &counters->hits, plan.hits}; }
    UnresolvedTest* beyond() const { return beyond_; }

   private:
    TestLists lists(FeatureTest* const* data, const unsigned long long* capacity, unsigned long long* count) const;
    template <int moments>
    FeatureRecord<moments>* records() const {
        return static_cast<FeatureRecord<moments>*>(records_);
    }
    template <class Work>
    void with_time_samples(Work work) const {
        primitives.moving ? work.template operator()<2>() : work.template operator()<1>();
    }

    void* records_ = nullptr;  ///< FeatureRecords of one time sample, or of two if the scene moves
    FeatureTest *tests_[feature_kinds] = {}, *open_[feature_kinds] = {};
    UnresolvedTest* beyond_ = nullptr;
    RankedHit* hits_ = nullptr;
};

}  // namespace crumple::cuda
