// Tests of given pairs of features: each is decided as by rational arithmetic, with any number of threads.

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>
#include <vector>

#include "crumple/crumple.h"
#include "error_of.h"
#include "exact/impact/exact_min_distance.h"
#include "exact/proximity/rational_distance.h"

namespace crumple {
namespace {

using Rows = std::vector<std::array<double, 3>>;

VertexView view(const Rows& rows) { return rows_of_three(rows.data()->data(), static_cast<std::int64_t>(rows.size())); }

// Returns random points of a small lattice, which give many degenerate cases.
Rows lattice(std::size_t rows, std::uint64_t seed, int extent) {
    std::mt19937_64 engine(seed);
    const auto number = [&] {
        return static_cast<double>(engine() % static_cast<std::uint64_t>(2 * extent + 1)) - extent;
    };
    Rows result(rows);
    for (auto& row : result) row = {number(), number(), number()};
    return result;
}

struct Kind {
    FeatureKind kind;
    FeatureKinds kinds;
};
constexpr std::array all_kinds{Kind{FeatureKind::vertex_face, FeatureKinds::vertex_face},
                               Kind{FeatureKind::edge_edge, FeatureKinds::edge_edge},
                               Kind{FeatureKind::vertex_edge, FeatureKinds::vertex_edge},
                               Kind{FeatureKind::vertex_vertex, FeatureKinds::vertex_vertex}};

Vec3d vec(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

Impact rational(FeatureKinds kinds, const std::array<MovingPoint, 4>& p, const MinDistance& separation) {
    if (kinds == FeatureKinds::vertex_face) return vertex_face(p[0], p[1], p[2], p[3], separation);
    if (kinds == FeatureKinds::edge_edge) return edge_edge(p[0], p[1], p[2], p[3], separation);
    if (kinds == FeatureKinds::vertex_edge) return vertex_edge(p[0], p[1], p[2], separation);
    return vertex_vertex(p[0], p[1], separation);
}

TEST(FeaturePairs, impacts_match_rational_arithmetic) {
    constexpr std::size_t pairs = 700;  // more pairs than one task decides
    for (const Kind& kind : all_kinds) {
        for (const PairImpactQuery& query : {PairImpactQuery{}, PairImpactQuery{0.5, 0, 3}, PairImpactQuery{0, 0.25, 3},
                                             PairImpactQuery{0, 0, 3, true}, PairImpactQuery{1.5, 0, 3, true}}) {
            const std::size_t points = points_of(kind.kinds);
            const Rows start = lattice(pairs * points, 1, 2), end = lattice(pairs * points, 2, 2);
            const PairImpacts found = pair_impacts(kind.kind, view(start), view(end), query);
            ASSERT_EQ(found.hit.size(), pairs);
            std::size_t hits = 0;
            for (std::size_t i = 0; i < pairs; ++i) {
                std::array<MovingPoint, 4> p{};
                for (std::size_t k = 0; k < points; ++k) p[k] = {vec(start[i * points + k]), vec(end[i * points + k])};
                const Impact impact =
                    rational(kind.kinds, p, {query.min_distance, query.min_distance_share, query.approaching_only});
                hits += impact.meets;
                ASSERT_EQ(found.hit[i], impact.meets) << "pair " << i;
                ASSERT_EQ(found.toi[i], impact.meets ? impact.toi : std::numeric_limits<double>::infinity());
                ASSERT_EQ(found.start[i], impact.start) << "pair " << i;
            }
            EXPECT_GT(hits, 0u);
            EXPECT_LT(hits, pairs);
        }
    }
}

TEST(FeaturePairs, distances_match_rational_arithmetic) {
    constexpr std::size_t pairs = 700;
    for (const Kind& kind : all_kinds) {
        const std::size_t points = points_of(kind.kinds);
        const Rows rows = lattice(pairs * points, 3, 2);
        const PairDistances found = pair_distances(kind.kind, view(rows), 3);
        ASSERT_EQ(found.type.size(), pairs);
        for (std::size_t i = 0; i < pairs; ++i) {
            Features features{kind.kinds, {}};
            for (std::size_t k = 0; k < points; ++k) features.point[k] = vec(rows[i * points + k]);
            const RationalDistance distance(features);
            ASSERT_EQ(found.squared_distance[i], distance.squared()) << "pair " << i;
            ASSERT_EQ(found.touching[i], distance.touching()) << "pair " << i;
            ASSERT_EQ(found.type[i], distance.closest().type) << "pair " << i;
            ASSERT_EQ(found.at[i], distance.closest().at) << "pair " << i;
        }
    }
}

TEST(FeaturePairs, strided_float32_points_are_read) {
    const Rows start = lattice(4 * 300, 4, 3), end = lattice(4 * 300, 5, 3);
    std::vector<std::array<float, 5>> strided(start.size());  // two unrelated numbers after each point
    for (std::size_t i = 0; i < start.size(); ++i)
        strided[i] = {static_cast<float>(start[i][0]), static_cast<float>(start[i][1]), static_cast<float>(start[i][2]),
                      9, 9};
    const VertexView odd{strided.data(), static_cast<std::int64_t>(strided.size()), 20, 4, ScalarType::float32};
    const PairImpacts found = pair_impacts(FeatureKind::vertex_face, odd, view(end)),
                      expected = pair_impacts(FeatureKind::vertex_face, view(start), view(end));
    for (std::size_t i = 0; i < expected.toi.size(); ++i) ASSERT_EQ(found.toi[i], expected.toi[i]) << "pair " << i;
    const PairDistances near = pair_distances(FeatureKind::vertex_face, odd),
                        expected_near = pair_distances(FeatureKind::vertex_face, view(start));
    ASSERT_EQ(near.squared_distance.size(), 300u);
    for (std::size_t i = 0; i < 300; ++i)
        ASSERT_EQ(near.squared_distance[i], expected_near.squared_distance[i]) << "pair " << i;
}

TEST(FeaturePairs, wrong_arguments_are_named_in_errors) {
    const Rows good = lattice(12, 6, 3);
    Rows bad = good;
    bad[9][1] = std::numeric_limits<double>::infinity();
    Error error = test::error_of([&] { pair_impacts(FeatureKind::vertex_face, view(good), view(bad)); });
    EXPECT_EQ(error.code, ErrorCode::not_finite);
    EXPECT_STREQ(error.what(), "end: point 1 of pair 2 is not finite");
    error = test::error_of([&] { pair_distances(FeatureKind::vertex_edge, view(bad)); });
    EXPECT_STREQ(error.what(), "points: point 0 of pair 3 is not finite");
    error = test::error_of([&] { pair_distances(FeatureKind::vertex_face, view(lattice(11, 6, 3))); });
    EXPECT_STREQ(error.what(), "points must have 4 rows per pair, and 11 is not a multiple of 4");
    error = test::error_of([&] { pair_distances(FeatureKind::vertex_face, {nullptr, 4, 24, 8, ScalarType::float64}); });
    EXPECT_STREQ(error.what(), "rows of points have no data");
    error = test::error_of([&] { pair_impacts(FeatureKind::vertex_edge, view(good), view(lattice(9, 6, 3))); });
    EXPECT_STREQ(error.what(), "end must have as many pairs as start, 4, not 3");
    error = test::error_of(
        [&] { pair_impacts(FeatureKind::edge_edge, view(good), view(good), {.min_distance_share = 1}); });
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_STREQ(error.what(), "min_distance_share must be 0 or more, and below 1");
    error = test::error_of([&] { pair_distances(static_cast<FeatureKind>(4), view(good)); });
    EXPECT_STREQ(error.what(), "kind must be a value of FeatureKind");
    error = test::error_of([&] { pair_distances(FeatureKind::edge_edge, view(good), -1); });
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_STREQ(error.what(), "threads must be 0 (as many as the machine has) or more");
}

TEST(FeaturePairs, stop_requested_before_a_call_cancels_it) {
    const Rows rows = lattice(12, 7, 3);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(test::error_of([&] {
                  pair_impacts(FeatureKind::vertex_face, view(rows), view(rows), {}, stop.get_token());
              }).code,
              ErrorCode::cancelled);
    EXPECT_EQ(test::error_of([&] { pair_distances(FeatureKind::edge_edge, view(rows), 0, stop.get_token()); }).code,
              ErrorCode::cancelled);
}

}  // namespace
}  // namespace crumple
