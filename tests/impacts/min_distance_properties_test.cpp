// Checks that some changes of a move leave the time at which its features come within a distance as it is, and that
// other changes have the expected effect.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "impacts/min_distance_moves.h"
#include "rounds.h"

namespace crumple {
namespace {

const int rounds = scaled_rounds(100);

/// Calls `check` with many moves. Fails unless, for each kind of features, some come within the minimum distance after
/// the start, and others never.
template <class Check>
void for_separated(std::uint64_t seed, Check check) {
    for (const Feature feature : all_features) {
        int hits = 0, later = 0, all = 0;
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, seed);
            for (int i = 0; i < rounds; ++i, ++all) {
                const MinDistanceMove query = separated(random, lattice, feature);
                const Impact impact = query.impact();
                hits += impact.meets;
                later += impact.toi > 0;
                check(query, impact);
                if (testing::Test::HasFatalFailure()) return;
            }
        }
        EXPECT_GT(later, all / 10);
        EXPECT_LT(hits, all);
    }
}

template <class Change>
MinDistanceMove with_positions(MinDistanceMove query, Change change) {
    for (MovingPoint& p : query.move.point) p = {change(p.start), change(p.end)};
    return query;
}

TEST(MinDistance, zero_min_distance_gives_the_impact_without_min_distance) {
    for_separated(3, [](MinDistanceMove query, const Impact&) {
        query.separation = {};
        const Impact impact = query.move.impact();
        ASSERT_EQ(query.impact(), impact) << query;
        query.separation.share = 0.5;
        ASSERT_TRUE(!impact.start || query.impact() == impact) << query;
    });
}

TEST(MinDistance, larger_min_distance_is_reached_no_later) {
    for_separated(5, [](MinDistanceMove query, const Impact& impact) {
        Impact closer = impact;
        for (int i = 0; i < 3; ++i) {
            query.separation.distance += 0.5;
            const Impact farther = query.impact();
            ASSERT_TRUE(farther.meets || !closer.meets) << query;
            ASSERT_TRUE(!closer.meets || farther.toi <= closer.toi) << query;
            ASSERT_TRUE(farther.start || !closer.start) << query;
            closer = farther;
        }
        const Impact touching = query.move.impact();
        ASSERT_TRUE(impact.meets || !touching.meets) << query;
        ASSERT_TRUE(!touching.meets || impact.toi <= touching.toi) << query;
    });
}

TEST(MinDistance, distance_and_share_give_the_earlier_impact) {
    for_separated(7, [](const MinDistanceMove& query, const Impact& impact) {
        MinDistanceMove distance = query, share = query;
        distance.separation.share = 0;
        share.separation.distance = 0;
        const Impact one = distance.impact(), other = share.impact();
        const bool first = one.meets && (!other.meets || one.toi < other.toi || one.start);
        ASSERT_EQ(impact, first ? one : other) << query;
    });
}

TEST(MinDistance, impact_does_not_depend_on_the_order_of_points) {
    for_separated(11, [](const MinDistanceMove& query, const Impact& impact) {
        const auto& [p, q, r, s] = query.move.point;
        const MinDistance& separation = query.separation;
        if (query.move.feature == Feature::vertex_face) {
            ASSERT_EQ(vertex_face(p, r, s, q, separation), impact) << query;
            ASSERT_EQ(vertex_face(p, r, q, s, separation), impact) << query;
        } else if (query.move.feature == Feature::edge_edge) {
            ASSERT_EQ(edge_edge(q, p, r, s, separation), impact) << query;
            ASSERT_EQ(edge_edge(p, q, s, r, separation), impact) << query;
            ASSERT_EQ(edge_edge(r, s, p, q, separation), impact) << query;
        } else if (query.move.feature == Feature::vertex_edge) {
            ASSERT_EQ(vertex_edge(p, r, q, separation), impact) << query;
        } else {
            ASSERT_EQ(vertex_vertex(q, p, separation), impact) << query;
        }
    });
}

TEST(MinDistance, impact_does_not_depend_on_the_axes) {
    for_separated(13, [](const MinDistanceMove& query, const Impact& impact) {
        ASSERT_EQ(with_positions(query, [](Vec3d p) { return Vec3d{p.y, -p.z, p.x}; }).impact(), impact) << query;
        // Turned and scaled by 3, 4, 5, so that distances are 5 times as long.
        MinDistanceMove turned = with_positions(query, [](Vec3d p) {
            return Vec3d{3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y, 5 * p.z};
        });
        if (query.separation.distance == 0.1) return;  // the product would be rounded
        turned.separation.distance *= 5;
        ASSERT_EQ(turned.impact(), impact) << query;
    });
}

TEST(MinDistance, impact_does_not_depend_on_the_unit) {
    for_separated(17, [](const MinDistanceMove& query, const Impact& impact) {
        for (const double unit : {0x1p-900, 0x1p-3, 0x1p900}) {
            MinDistanceMove scaled = with_positions(query, [&](Vec3d p) { return unit * p; });
            scaled.separation.distance *= unit;
            ASSERT_EQ(scaled.impact(), impact) << query << " by " << unit;
        }
    });
}

TEST(MinDistance, impact_does_not_depend_on_the_origin) {
    for_separated(19, [](const MinDistanceMove& query, const Impact& impact) {
        const Vec3d shift{0x1p40, -1e6, 0.25};
        ASSERT_EQ(with_positions(query, [&](Vec3d p) { return p + shift; }).impact(), impact) << query;
        MinDistanceMove moving = query;
        for (MovingPoint& p : moving.move.point) p.end = p.end + shift;
        ASSERT_EQ(moving.impact(), impact) << query;
    });
}

TEST(MinDistance, half_of_the_move_doubles_the_time_of_impact) {
    for_separated(23, [](const MinDistanceMove& query, const Impact& impact) {
        MinDistanceMove half = query;
        for (MovingPoint& p : half.move.point) p.end = 0.5 * (p.start + p.end);
        const Impact first = half.impact();
        if (impact.meets && impact.toi < 0.5) {
            ASSERT_EQ(first, (Impact{true, 2 * impact.toi, impact.start})) << query;
        } else if (first.meets) {
            ASSERT_EQ(first.toi, 1) << query;  // the whole move has its impact at 1/2
            ASSERT_EQ(impact.toi, 0.5) << query;
        }
    });
}

TEST(MinDistance, reversed_move_reaches_the_min_distance_iff_the_move_does) {
    for_separated(29, [](const MinDistanceMove& query, const Impact&) {
        MinDistanceMove forward = query, back = query;
        forward.separation.share = back.separation.share = 0;  // a share refers to the distance at the start
        for (MovingPoint& p : back.move.point) std::swap(p.start, p.end);
        const Impact first = forward.impact(), last = back.impact();
        ASSERT_EQ(first.meets, last.meets) << query;
        ASSERT_TRUE(!first.meets || first.toi <= 1 - last.toi) << query;
    });
}

TEST(MinDistance, collapsed_features_have_the_impacts_of_smaller_ones) {
    for_separated(31, [](const MinDistanceMove& query, const Impact& impact) {
        const auto& [p, q, r, s] = query.move.point;
        const MinDistance& separation = query.separation;
        if (query.move.feature == Feature::vertex_edge) {
            ASSERT_EQ(vertex_face(p, q, r, r, separation), impact) << query;
            ASSERT_EQ(vertex_face(p, r, q, r, separation), impact) << query;
            ASSERT_EQ(edge_edge(p, p, q, r, separation), impact) << query;
        } else if (query.move.feature == Feature::vertex_vertex) {
            ASSERT_EQ(vertex_edge(p, q, q, separation), impact) << query;
            ASSERT_EQ(vertex_face(p, q, q, q, separation), impact) << query;
            ASSERT_EQ(edge_edge(p, p, q, q, separation), impact) << query;
        }
    });
}

TEST(MinDistance, impact_on_an_edge_is_the_earlier_of_its_halves) {
    // The midpoint of the edge moves on a straight line, too.
    for_separated(37, [](const MinDistanceMove& query, const Impact&) {
        if (query.move.feature != Feature::vertex_edge) return;
        const auto& [p, q, r, s] = query.move.point;
        const MinDistance separation{query.separation.distance};
        const MovingPoint middle{0.5 * (q.start + r.start), 0.5 * (q.end + r.end)};
        const Impact left = vertex_edge(p, q, middle, separation), right = vertex_edge(p, middle, r, separation);
        const Impact whole = vertex_edge(p, q, r, separation);
        const bool first = left.meets && (!right.meets || left.toi < right.toi || left.start);
        ASSERT_EQ(whole, first ? left : right) << query;
    });
}

}  // namespace
}  // namespace crumple
