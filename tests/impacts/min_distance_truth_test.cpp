// Compares minimum distances between frames of real scenes with exact results of external origin: impacts, whose
// minimum distance is 0, and squared distances at the start.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "exact/impact/decide_min_distance.h"
#include "impacts/min_distance_moves.h"
#include "impacts/scene_impacts.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

/// A pair of features that are near each other at the start.
struct NearMove {
    Move move;
    double squared_distance;  ///< at the start, rounded to float64
};

/// Returns one of `every` lines of a file, or nothing without the data.
std::vector<NearMove> read_near_moves(const SceneStep& step, const std::string& result_file, int every) {
    const auto folder = io::test::data_folder();
    if (!folder || !fs::exists(*folder / "gt-motion" / result_file)) return {};
    const Frames frames(*folder / "scalable-ccd" / step.start, *folder / "scalable-ccd" / step.end);
    std::ifstream file(*folder / "gt-motion" / result_file);
    std::vector<NearMove> moves;
    std::string kind;
    for (int line = 0; file >> kind; ++line) {
        std::array<std::int32_t, 4> id{};
        const bool face = kind == "vf";
        for (std::size_t i = 0; i < (face ? 2U : 4U); ++i) file >> id[i];
        double squared = 0;
        if (!(file >> squared)) throw std::runtime_error(result_file + " breaks off");
        if (line % every != 0) continue;
        std::array<MovingPoint, 4> point;
        for (std::size_t i = 0; i < 4; ++i)
            point[i] = face && i > 0 ? frames.corner(id[1], i - 1) : frames.vertex(id[i]);
        moves.push_back({{face ? Feature::vertex_face : Feature::edge_edge, point}, squared});
    }
    return moves;
}

Impact decide(const Move& move, const MinDistance& separation, MinDistanceCounts& counts) {
    return decide_min_distance(static_cast<FeatureKinds>(move.feature), move.point, separation, counts);
}

class MinDistanceTruth : public testing::TestWithParam<std::size_t> {
   protected:
    static constexpr const char* distances[] = {"prox_cloth-funnel_227.txt", "prox_cloth-ball_92.txt",
                                                "prox_n-body_18.txt"};

    void SetUp() override {
        near_ = read_near_moves(step(), distances[GetParam()], 20);
        if (near_.empty()) GTEST_SKIP() << "no answers for moving scenes: set CRUMPLE_DATA";
        ASSERT_GT(near_.size(), 1000U);
    }

    const SceneStep& step() const { return scene_steps[GetParam()]; }

    std::vector<NearMove> near_;
};

TEST_P(MinDistanceTruth, zero_min_distance_gives_exact_impacts) {
    const auto impacts = *read_impacts(step());
    const std::size_t every = impacts.size() < 1000 ? 1 : 150;
    for (std::size_t i = 0; i < impacts.size(); i += every)
        EXPECT_EQ((MinDistanceMove{impacts[i].move, {}}).impact(), impacts[i].impact) << impacts[i].move;
}

TEST_P(MinDistanceTruth, start_flag_is_set_just_above_and_unset_just_below_the_initial_distance) {
    MinDistanceCounts within, beyond;
    std::int64_t touching = 0;
    for (std::size_t i = 0; i < near_.size(); ++i) {
        const auto& [move, squared] = near_[i];
        // The squared distance and its root are rounded. 1 ± 2^-51 exceeds the relative error of both.
        const double distance = std::sqrt(squared);
        EXPECT_TRUE(decide(move, {distance * (1 + 0x1p-51), 0}, within).start) << move;
        touching += distance == 0;
        // Approaching pairs come within the slightly smaller distance so soon after the start that the decision takes
        // rational arithmetic; so only one pair in ten is tested.
        if (distance == 0 || i % 10 != 0) continue;
        EXPECT_FALSE(decide(move, {distance * (1 - 0x1p-51), 0}, beyond).start) << move;
    }
    EXPECT_EQ(within.rational, touching);
}

TEST_P(MinDistanceTruth, float64_impacts_match_rational_arithmetic) {
    MinDistanceCounts counts;
    std::int64_t queries = 0, later = 0;
    for (std::size_t i = 0; i < near_.size(); ++i) {
        const auto& [move, squared] = near_[i];
        if (squared == 0) continue;
        const double distance = std::sqrt(squared);
        for (const MinDistance& separation : {MinDistance{0.5 * distance, 0}, {0.9 * distance, 0}, {0, 0.1}}) {
            const Impact impact = decide(move, separation, counts);
            ++queries;
            later += impact.meets;
            // Rational arithmetic is slow.
            if (i % 20 == 0) {
                EXPECT_EQ(impact, (MinDistanceMove{move, separation}).impact()) << move << separation;
            }
        }
    }
    EXPECT_GT(later, queries / 100);
    EXPECT_LE(counts.rational, queries / 500);
}

INSTANTIATE_TEST_SUITE_P(GroundTruth, MinDistanceTruth, testing::Range(std::size_t{0}, scene_steps.size()),
                         [](const auto& info) { return name_of(scene_steps[info.param]); });

}  // namespace
}  // namespace crumple
