// Compares impacts between frames of real scenes bit by bit with exact results of external origin.

#include <gtest/gtest.h>

#include "impacts/decided_moves.h"
#include "impacts/scene_impacts.h"

namespace crumple {
namespace {

class ImpactTruth : public testing::TestWithParam<SceneStep> {
   protected:
    void SetUp() override {
        auto impacts = read_impacts(GetParam());
        if (!impacts) GTEST_SKIP() << "no answers for moving scenes: set CRUMPLE_DATA";
        impacts_ = std::move(*impacts);
        ASSERT_EQ(impacts_.size(), GetParam().impacts);
    }

    std::vector<SceneImpact> impacts_;
};

TEST_P(ImpactTruth, rational_impacts_match_ground_truth_to_the_last_bit) {
    // Rational arithmetic is slow.
    const std::size_t every = impacts_.size() < 1000 ? 1 : 50;
    for (std::size_t i = 0; i < impacts_.size(); i += every) {
        const auto& [move, impact] = impacts_[i];
        EXPECT_EQ(move.impact(), impact) << "line " << i << ": " << move;
    }
}

TEST_P(ImpactTruth, float64_impacts_match_ground_truth_to_the_last_bit) {
    ImpactCounts counts;
    for (std::size_t i = 0; i < impacts_.size(); ++i) {
        const auto& [move, impact] = impacts_[i];
        ASSERT_EQ(decide(move, counts), impact) << "line " << i << ": " << move;
    }
    EXPECT_EQ(counts.roots, static_cast<std::int64_t>(impacts_.size()));
    // In the funnel scene, some of the few impacts are of edges that stay in one plane, and need the exact decision.
    EXPECT_LE(counts.exact, std::max<std::int64_t>(20, counts.roots / 1000));
}

/// Combines the first feature of each line with the second of the next line: near misses are common, impacts rare.
TEST_P(ImpactTruth, near_misses_agree_with_the_exact_decision) {
    ImpactCounts counts;
    std::int64_t queries = 0, hits = 0;
    for (std::size_t i = 0; i + 1 < impacts_.size(); ++i) {
        const Move &one = impacts_[i].move, &other = impacts_[i + 1].move;
        if (one.feature != other.feature) continue;
        Move move = one;
        std::copy(other.point.begin() + (one.feature == Feature::vertex_face ? 1 : 2), other.point.end(),
                  move.point.begin() + (one.feature == Feature::vertex_face ? 1 : 2));
        const Impact found = decide(move, counts);
        ++queries;
        hits += found.meets;
        if (queries % 16 == 0) {
            ASSERT_EQ(found, move.impact()) << move;
        }
    }
    EXPECT_GT(counts.roots, hits) << "no near misses";
    EXPECT_LE(counts.exact, std::max<std::int64_t>(20, queries / 1000));
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, ImpactTruth, testing::ValuesIn(scene_steps),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
}  // namespace crumple
