// Test of stage `align`: boxes with their margin hold their triangles, including big members, whose coordinates exceed
// the limit LeafFrame::big.

#include "stages/cases.h"

namespace crumple::test {
namespace {

using Align = Stages;
INSTANTIATE_TEST_SUITE_P(, Align, testing::ValuesIn(stage_backends()), [](const auto& b) { return b.param.name; });

TEST_P(Align, boxes_with_their_margin_hold_their_triangles) {
    run([](const StageCase& the, const StageState& state) {
        for (const LeafState& leaf : state.leaves) {
            if (leaf.member.size() < 2) continue;
            ASSERT_EQ(leaf.box.size(), leaf.member.size());
            const std::vector<ExactBox> exact = exact_boxes(state, the.scene, leaf);
            for (std::size_t i = 0; i < exact.size(); ++i)
                for (int axis = 0; axis < 3; ++axis)
                    ASSERT_TRUE(exact[i].within(leaf.box[i], axis))
                        << "triangle " << leaf.member[i] << ", axis " << axis;
        }
    });
}

}  // namespace
}  // namespace crumple::test
