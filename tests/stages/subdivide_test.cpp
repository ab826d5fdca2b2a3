// Tests of stage `subdivide`: triangles with a common point, or that come near in motion, share a leaf, and exactly one
// leaf owns the pair.

#include <map>

#include "stages/cases.h"

namespace crumple::test {
namespace {

using Subdivide = Stages;
INSTANTIATE_TEST_SUITE_P(, Subdivide, testing::ValuesIn(stage_backends()), [](const auto& b) { return b.param.name; });

TEST_P(Subdivide, exactly_one_leaf_owns_each_pair_with_a_common_point) {
    run([](const StageCase& the, const StageState& state) {
        std::map<Pair, int> owners;
        for (const LeafState& leaf : state.leaves)
            for (const Pair& pair : leaf.owned) ++owners[pair];
        for (const Pair& pair : the.meeting()) ASSERT_EQ(owners[pair], 1) << pair.a << ' ' << pair.b << " meet";
        for (const auto& [pair, count] : owners) ASSERT_LE(count, 1) << pair.a << ' ' << pair.b;
    });
}

TEST_P(Subdivide, no_leaf_lists_a_triangle_twice) {
    run([](const StageCase& the, const StageState& state) {
        for (const LeafState& leaf : state.leaves) {
            std::vector<std::int32_t> members = leaf.member;
            std::sort(members.begin(), members.end());
            ASSERT_EQ(std::adjacent_find(members.begin(), members.end()), members.end());
            ASSERT_TRUE(members.empty() || (members.front() >= 0 && members.back() < the.scene.triangle_count()));
        }
    });
}

}  // namespace
}  // namespace crumple::test
