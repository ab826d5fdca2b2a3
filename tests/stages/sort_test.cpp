// Test of stage `sort`: rows before `end` include every overlap along the sweep direction once.

#include "stages/cases.h"

namespace crumple::test {
namespace {

using Sort = Stages;
INSTANTIATE_TEST_SUITE_P(, Sort, testing::ValuesIn(stage_backends()), [](const auto& b) { return b.param.name; });

TEST_P(Sort, each_overlap_along_the_sweep_direction_occurs_once) {
    run([](const StageCase& the, const StageState& state) {
        for (const LeafState& leaf : state.leaves) {
            std::vector<Pair> met = leaf.met;
            std::sort(met.begin(), met.end());
            ASSERT_EQ(std::adjacent_find(met.begin(), met.end()), met.end()) << "a pair twice";
            const std::vector<ExactBox> exact = exact_boxes(state, the.scene, leaf);
            for (std::size_t i = 0; i < exact.size(); ++i)
                for (std::size_t j = i + 1; j < exact.size(); ++j) {
                    const std::int32_t a = leaf.member[i], b = leaf.member[j];
                    if (the.scene.between && the.scene.second(a) == the.scene.second(b)) continue;
                    if (!exact[i].overlaps(exact[j], 0)) continue;
                    ASSERT_TRUE(std::binary_search(met.begin(), met.end(), Pair{std::min(a, b), std::max(a, b)}))
                        << a << ' ' << b;
                }
        }
    });
}

}  // namespace
}  // namespace crumple::test
