// Tests of stage `sweep`: every overlap of boxes that the leaf owns is listed once, and none that another leaf owns. So
// every pair with a common point, or that comes near in motion, is a candidate of one leaf.

#include "stages/cases.h"

namespace crumple::test {
namespace {

using Sweep = Stages;
INSTANTIATE_TEST_SUITE_P(, Sweep, testing::ValuesIn(stage_backends()), [](const auto& b) { return b.param.name; });

std::vector<Pair> sorted(std::vector<Pair> pairs) {
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

TEST_P(Sweep, each_overlap_that_the_leaf_owns_is_listed_once) {
    run([](const StageCase& the, const StageState& state) {
        for (const LeafState& leaf : state.leaves) {
            const std::vector<Pair> found = sorted(leaf.candidates), owned = sorted(leaf.owned);
            ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "a pair twice";
            if (leaf.sweep_checks_owners) {
                ASSERT_TRUE(std::includes(owned.begin(), owned.end(), found.begin(), found.end())) << "another's pair";
            }
            const std::vector<ExactBox> exact = exact_boxes(state, the.scene, leaf);
            for (std::size_t i = 0; i < exact.size(); ++i)
                for (std::size_t j = i + 1; j < exact.size(); ++j) {
                    const std::int32_t a = leaf.member[i], b = leaf.member[j];
                    const Pair pair{std::min(a, b), std::max(a, b)};
                    if (!std::binary_search(owned.begin(), owned.end(), pair)) continue;
                    bool overlap = true;
                    for (int axis = 0; axis < 3; ++axis) overlap = overlap && exact[i].overlaps(exact[j], axis);
                    if (!overlap) continue;
                    ASSERT_TRUE(std::binary_search(found.begin(), found.end(), pair)) << a << ' ' << b;
                }
        }
    });
}

TEST_P(Sweep, owner_leaf_lists_each_pair_with_a_common_point) {
    run([](const StageCase& the, const StageState& state) {
        std::vector<Pair> listed;
        for (const LeafState& leaf : state.leaves) {
            const std::vector<Pair> found = sorted(leaf.candidates), owned = sorted(leaf.owned);
            std::set_intersection(found.begin(), found.end(), owned.begin(), owned.end(), std::back_inserter(listed));
        }
        std::sort(listed.begin(), listed.end());
        ASSERT_EQ(std::adjacent_find(listed.begin(), listed.end()), listed.end()) << "a pair twice";
        std::vector<Pair> lost;
        std::set_difference(the.meeting().begin(), the.meeting().end(), listed.begin(), listed.end(),
                            std::back_inserter(lost));
        ASSERT_TRUE(lost.empty()) << lost.size() << " lost, " << lost[0].a << ' ' << lost[0].b << " among them";
    });
}

TEST_P(Sweep, few_pairs_whose_boxes_are_disjoint_along_y_or_z_are_listed) {
    run([](const StageCase&, const StageState& state) {
        std::size_t members = 0, candidates = 0, apart = 0;
        for (const LeafState& leaf : state.leaves) {
            members += leaf.member.size();
            candidates += leaf.candidates.size();
            for (const Pair& pair : leaf.candidates) {
                const auto box = [&](std::int32_t t) {
                    return leaf.box[static_cast<std::size_t>(std::find(leaf.member.begin(), leaf.member.end(), t) -
                                                             leaf.member.begin())];
                };
                const Box a = box(pair.a), b = box(pair.b);
                // The sweep direction (x) is not compared: along it, coarse bins let disjoint boxes pass. Along y and
                // z, disjoint boxes pass only due to rounding to 16 bits.
                apart += a.low.y > b.high.y || b.low.y > a.high.y || a.low.z > b.high.z || b.low.z > a.high.z;
            }
        }
        ASSERT_LE(apart, candidates / 100 + members / 50 + 2);
    });
}

}  // namespace
}  // namespace crumple::test
