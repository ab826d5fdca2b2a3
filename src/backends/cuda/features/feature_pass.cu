#include "backends/cuda/features/feature_pass.h"

#include "backends/cuda/features/feature_records.h"

namespace crumple::cuda {

void FeaturePass::cut(ArenaLayout& c) {
    Pass::cut(c);
    with_time_samples([&]<int moments>() { records_ = c.take<FeatureRecord<moments>>(plan.last_members()); });
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        tests_[k] = c.take<FeatureTest>(plan.tests[k]);
        open_[k] = c.take<FeatureTest>(plan.open[k]);
    }
    beyond_ = c.take<UnresolvedTest>(plan.beyond);
    hits_ = c.take<RankedHit>(plan.hits);
}

void FeaturePass::sort() {
    with_time_samples([&]<int moments>() {
        sort_by(Widened<moments>{primitives.ends, primitives.inflation},
                FeatureMemberRows<moments>{records<moments>(), asked.features});
    });
}

void FeaturePass::sweep(const Slice& slice) {
    with_time_samples([&]<int moments>() {
        sweep_by(slice, SeparatingAxisTest<moments>{records<moments>(), frames(), sorted_.leaf, asked.inflation,
                                                    asked.triangle_radius, share_to_filter(asked.share)});
    });
}

TestLists FeaturePass::lists(FeatureTest* const* data, const unsigned long long* capacity,
                             unsigned long long* count) const {
    TestLists lists;
    for (std::size_t k = 0; k < feature_kinds; ++k) lists.of[k] = {data[k], count + k, capacity[k]};
    return lists;
}

void FeaturePass::narrow(const FeatureHits& hits) {
    const TestLists tests = lists(tests_, plan.tests, counters->tests), open = lists(open_, plan.open, counters->open);
    with_time_samples([&]<int moments>() {
        list_tests(geometry_, stream_, FeatureSurvivors<moments>{survivors(), records<moments>()}, points_.rows(),
                   primitives.ends, asked, all_kinds, tests, hits, counters);
    });
    decide_tests(geometry_, stream_, scene, asked, all_kinds, tests, open, {beyond_, &counters->beyond, plan.beyond},
                 hits);
}

}  // namespace crumple::cuda
