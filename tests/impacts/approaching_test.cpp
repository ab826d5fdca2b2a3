// Tests of the option approaching_only: features that start within the minimum distance are reported only if, and when,
// they come nearer than they are at the start. Handmade cases, and float64 compared with rational arithmetic.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exact/impact/decide_min_distance.h"
#include "exact/impact/filtered_closing.h"
#include "impacts/min_distance_moves.h"

namespace crumple {
namespace approaching {
namespace {

constexpr Impact none{};
constexpr Impact at_once{true, 0, true};
constexpr MinDistance within_two{.distance = 2, .approaching_only = true};

MovingPoint still(double x, double y, double z) { return {{x, y, z}, {x, y, z}}; }

/// Returns the impact of a vertex on the face with corners (0, 0, 0), (4, 0, 0), (0, 4, 0).
Impact to_face(Vec3d start, Vec3d end, const MinDistance& separation = within_two) {
    return vertex_face({start, end}, still(0, 0, 0), still(4, 0, 0), still(0, 4, 0), separation);
}

TEST(ApproachingOnly, leaves_out_features_that_do_not_approach) {
    EXPECT_EQ(to_face({1, 1, 1}, {1, 1, 3}), none);
    EXPECT_EQ(to_face({1, 1, 1}, {1, 1, 1}), none);
    EXPECT_EQ(to_face({1, 1, 1}, {2, 1, 1}), none);
    EXPECT_EQ(to_face({1, 1, 1}, {9, 1, 1}), none);
    EXPECT_EQ(to_face({1, 1, 2}, {1, 1, 3}), none);
    EXPECT_EQ(vertex_vertex(still(0, 0, 0), {{1, 0, 0}, {1, 9, 0}}, within_two),
              none);  // starts at a right angle to the direction of the other vertex
}

TEST(ApproachingOnly, reports_features_that_approach_from_the_start_at_time_zero) {
    EXPECT_EQ(to_face({1, 1, 1}, {1, 1, 0.5}), at_once);
    EXPECT_EQ(to_face({1, 1, 1}, {1, 1, std::nextafter(1., 0.)}), at_once);
    EXPECT_EQ(to_face({1, 1, 1}, {1, 1, -9}), at_once);
    EXPECT_EQ(to_face({1, 1, 2}, {1, 1, 1}), at_once);  // starts exactly at the distance
    EXPECT_EQ(vertex_vertex(still(0, 0, 0), {{1, 1, 0}, {1, -1, 0}}, within_two), at_once);
}

TEST(ApproachingOnly, reports_features_when_they_return_to_their_initial_distance) {
    // The near end of the edge moves away; then the rest of the edge sweeps through the vertex. At time t the edge is
    // at height (1 + 8 t) - (9 t) s over x = (8 - 16 t) s, for s in [0, 1].
    const MovingPoint vertex = still(0, 0, 0), near{{0, 1, 0}, {0, 9, 0}}, far{{8, 1, 0}, {-8, 0, 0}};
    const Impact back = vertex_edge(vertex, near, far, within_two);
    EXPECT_TRUE(back.meets);
    EXPECT_FALSE(back.start);
    // The far end is then at the initial distance: 257 t² - 258 t + 64 = 0, so t = (258 - sqrt(772)) / 514.
    EXPECT_GT(back.toi, 0.4478);
    EXPECT_LT(back.toi, 0.4479);
    // An edge that starts beyond the distance is found when it comes within the distance.
    const Impact from_beyond = vertex_edge(vertex, near, far, {.distance = 0.5, .approaching_only = true});
    EXPECT_EQ(from_beyond, vertex_edge(vertex, near, far, {.distance = 0.5}));
    EXPECT_LT(back.toi, from_beyond.toi);
    EXPECT_EQ(vertex_edge(vertex, near, far, {.distance = 1, .approaching_only = true}), back);
}

TEST(ApproachingOnly, time_of_return_to_the_initial_distance_is_exact) {
    // The near end of the edge leaves sideways. The far end, at x = 16 t - 9, is at the near end's initial place at t =
    // 1/2.
    const MovingPoint near{{-1, 0, 0}, {-1, 0, 100}}, far{{-9, 0, 0}, {7, 0, 0}};
    EXPECT_EQ(vertex_edge(still(0, 0, 0), near, far, within_two), (Impact{true, 0.5, false}));
    EXPECT_EQ(vertex_edge(still(0, 0, 0), near, {{-9, 0, 0}, {-1, 0, 0}}, within_two), none);
}

TEST(ApproachingOnly, edge_that_turns_towards_a_vertex_approaches_but_one_that_slides_does_not) {
    // An edge that turns towards the vertex about its nearest point, and edges that slide or turn without approaching.
    const MovingPoint vertex = still(0, 0, 1);
    EXPECT_EQ(vertex_edge(vertex, {{-4, 0, 0}, {-4, 0, 2}}, {{4, 0, 0}, {4, 0, -2}}, within_two), at_once);
    EXPECT_EQ(vertex_edge(vertex, {{-4, 0, 0}, {-3, 0, 0}}, {{4, 0, 0}, {5, 0, 0}}, within_two), none);
    EXPECT_EQ(vertex_edge(vertex, {{-4, 0, 0}, {-4, 1, 0}}, {{4, 0, 0}, {4, 1, 0}}, within_two), none);
    EXPECT_EQ(vertex_edge(vertex, {{-4, 0, 0}, {-4, 1, 0}}, {{4, 0, 0}, {4, -1, 0}}, within_two), none);
}

TEST(ApproachingOnly, leaves_out_features_that_touch_at_the_start) {
    for (const double distance : {0., 1.}) {
        const MinDistance separation{.distance = distance, .approaching_only = true};
        for (const double height : {-1., 0., 1.}) EXPECT_EQ(to_face({1, 1, 0}, {1, 1, height}, separation), none);
    }
    EXPECT_EQ(to_face({1, 1, 1}, {1, 1, -1}, {.approaching_only = true}), (Impact{true, 0.5, false}));
    EXPECT_EQ(to_face({1, 1, 0}, {1, 1, -1}, {.share = 0.5, .approaching_only = true}), none);
}

TEST(ApproachingOnly, parallel_edges_are_reported_if_one_end_approaches) {
    const MovingPoint a = still(0, 0, 0), b = still(4, 0, 0);
    EXPECT_EQ(edge_edge(a, b, {{0, 0, 1}, {0, 0, 2}}, {{4, 0, 1}, {4, 0, 0.5}}, within_two), at_once);
    EXPECT_EQ(edge_edge(a, b, {{0, 0, 1}, {0, 0, 2}}, {{4, 0, 1}, {4, 0, 1}}, within_two), none);
    EXPECT_EQ(edge_edge(a, b, {{0, 0, 1}, {1, 0, 1}}, {{4, 0, 1}, {5, 0, 1}}, within_two), none);
}

FilteredImpact quickly(const Move& move) {
    switch (move.feature) {
        case Feature::vertex_face:
            return filtered_closing<FeatureKinds::vertex_face>(move.point);
        case Feature::edge_edge:
            return filtered_closing<FeatureKinds::edge_edge>(move.point);
        case Feature::vertex_edge:
            return filtered_closing<FeatureKinds::vertex_edge>(move.point);
        case Feature::vertex_vertex:
            break;
    }
    return filtered_closing<FeatureKinds::vertex_vertex>(move.point);
}

/// Numbers of moves by verdict.
struct Tally {
    int apart = 0, start = 0, unknown = 0;
};

void check(const Move& move, Tally& tally) {
    const MinDistanceMove query{move, {.distance = 1e30, .approaching_only = true}};
    const Impact exact = query.impact();
    const FilteredImpact quick = quickly(move);
    ++(quick.verdict == Certainty::unknown ? tally.unknown
       : quick.verdict == Certainty::apart ? tally.apart
                                           : tally.start);
    if (quick.verdict != Certainty::unknown) {
        ASSERT_EQ((Impact{quick.verdict == Certainty::meets, quick.toi, quick.start}), exact) << query;
    }
    MinDistanceCounts counts;
    ASSERT_EQ(decide_min_distance(static_cast<FeatureKinds>(move.feature), move.point, query.separation, counts), exact)
        << query;
}

class ApproachingFilter : public testing::TestWithParam<Feature> {};

TEST_P(ApproachingFilter, certain_verdicts_agree_with_rational_arithmetic) {
    Tally tally;
    for (const Lattice lattice : all_lattices) {
        RandomMoves random(lattice, 47);
        for (int i = 0; i < 150; ++i) ASSERT_NO_FATAL_FAILURE(check(random(GetParam()), tally));
    }
    EXPECT_GT(tally.apart, 20);
    EXPECT_GT(tally.start, 20);
}

/// Uses moves that change the distance by a few units in the last place at most.
TEST_P(ApproachingFilter, is_right_or_undecided_if_the_distance_changes_by_a_few_ulps_at_most) {
    Tally tally;
    RandomMoves random(Lattice::tiny, 53);
    for (int i = 0; i < 300; ++i) {
        Move move = random(GetParam());
        const int axis = i % 3, away = i / 3 % 5 - 2;
        for (std::size_t k = 0; k < points_of(move.feature); ++k) {
            MovingPoint& p = move.point[k];
            p.end = p.start;
            const bool first = k < (move.feature == Feature::edge_edge ? 2u : 1u);
            if (first) p.end[axis] += away * 0x1p-50;
            if (i % 2 == 0) p.end[(axis + 1) % 3] += 1;
        }
        ASSERT_NO_FATAL_FAILURE(check(move, tally));
    }
    EXPECT_GT(tally.unknown, 20);
}

std::string name_of(const testing::TestParamInfo<Feature>& info) {
    constexpr const char* names[] = {"VertexFace", "EdgeEdge", "VertexEdge", "VertexVertex"};
    return names[static_cast<int>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Features, ApproachingFilter, testing::ValuesIn(all_features), name_of);

}  // namespace
}  // namespace approaching
}  // namespace crumple
