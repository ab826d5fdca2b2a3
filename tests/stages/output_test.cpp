// Test of stage `output`: pairs in lexicographic order, with the second mesh's own numbering, and offsets and hit flags
// that match them.

#include "stages/cases.h"

namespace crumple::test {
namespace {

using OutputStage = Stages;
INSTANTIATE_TEST_SUITE_P(, OutputStage, testing::ValuesIn(stage_backends()),
                         [](const auto& b) { return b.param.name; });

TEST_P(OutputStage, pairs_are_sorted_and_offsets_and_flags_match_them) {
    run_static([](const StageCase& the, const StageState& state) {
        const PreparedScene& scene = the.scene;
        const auto first = static_cast<std::int32_t>(scene.triangles[0]);
        std::vector<Pair> pairs;
        std::vector<std::int64_t> offsets(static_cast<std::size_t>(first) + 1, 0);
        std::vector<std::uint8_t> hit(static_cast<std::size_t>(first), 0);
        std::vector<std::uint8_t> hit_second(static_cast<std::size_t>(scene.triangles[1]), 0);
        for (const Pair& pair : the.colliding()) {
            const std::int32_t b = pair.b - (scene.between ? first : 0);
            pairs.push_back({pair.a, b});
            for (std::int32_t a = pair.a; a < first; ++a) ++offsets[static_cast<std::size_t>(a) + 1];
            hit[static_cast<std::size_t>(pair.a)] = 1;
            (scene.between ? hit_second : hit)[static_cast<std::size_t>(b)] = 1;
        }
        ASSERT_EQ(pairs_of(state.result), pairs);
        ASSERT_TRUE(std::ranges::equal(state.result.offsets, offsets));
        ASSERT_TRUE(std::ranges::equal(state.result.hit, hit));
        ASSERT_TRUE(std::ranges::equal(state.result.hit_second, hit_second));
    });
}

}  // namespace
}  // namespace crumple::test
