// Test of stage `narrow`: exactly the colliding pairs remain, each once, whichever leaf owns it.

#include "stages/cases.h"

namespace crumple::test {
namespace {

using Narrow = Stages;
INSTANTIATE_TEST_SUITE_P(, Narrow, testing::ValuesIn(stage_backends()), [](const auto& b) { return b.param.name; });

TEST_P(Narrow, exactly_the_colliding_pairs_remain) {
    std::size_t all = 0;
    run_static([&](const StageCase& the, const StageState& state) {
        std::vector<Pair> found;
        for (const LeafState& leaf : state.leaves) found.insert(found.end(), leaf.found.begin(), leaf.found.end());
        std::sort(found.begin(), found.end());
        ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "a pair twice";
        ASSERT_EQ(difference(the.colliding(), found), "");
        all += found.size();
    });
    EXPECT_GT(all, 100U);
}

}  // namespace
}  // namespace crumple::test
