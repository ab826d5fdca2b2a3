// What must not change when features come within a distance, and what must change it in a known way.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "impacts/separated_moves.h"
#include "rounds.h"

namespace crumple {
namespace {

const int rounds = more_or_less(100);

/// Calls `check` with many moves, and fails unless some of each kind come close enough, not all at once, and some do
/// not.
template <class Check>
void for_separated(std::uint64_t seed, Check check) {
    for (const Feature feature : all_features) {
        int hits = 0, later = 0, all = 0;
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, seed);
            for (int i = 0; i < rounds; ++i, ++all) {
                const SeparatedMove asked = separated(random, lattice, feature);
                const Impact impact = asked.impact();
                hits += impact.meets;
                later += impact.toi > 0;
                check(asked, impact);
                if (testing::Test::HasFatalFailure()) return;
            }
        }
        EXPECT_GT(later, all / 10);
        EXPECT_LT(hits, all);
    }
}

template <class Change>
SeparatedMove with_positions(SeparatedMove asked, Change change) {
    for (MovingPoint& p : asked.move.point) p = {change(p.start), change(p.end)};
    return asked;
}

TEST(Separation, OfNothingIsAnImpact) {
    for_separated(3, [](SeparatedMove asked, const Impact&) {
        asked.separation = {};
        const Impact impact = asked.move.impact();
        ASSERT_EQ(asked.impact(), impact) << asked;
        asked.separation.share = 0.5;
        ASSERT_TRUE(!impact.start || asked.impact() == impact) << asked;
    });
}

TEST(Separation, ComesNoLaterForMoreDistance) {
    for_separated(5, [](SeparatedMove asked, const Impact& impact) {
        Impact closer = impact;
        for (int i = 0; i < 3; ++i) {
            asked.separation.distance += 0.5;
            const Impact farther = asked.impact();
            ASSERT_TRUE(farther.meets || !closer.meets) << asked;
            ASSERT_TRUE(!closer.meets || farther.toi <= closer.toi) << asked;
            ASSERT_TRUE(farther.start || !closer.start) << asked;
            closer = farther;
        }
        const Impact touching = asked.move.impact();
        ASSERT_TRUE(impact.meets || !touching.meets) << asked;
        ASSERT_TRUE(!touching.meets || impact.toi <= touching.toi) << asked;
    });
}

TEST(Separation, IsTheEarlierOfDistanceAndShare) {
    for_separated(7, [](const SeparatedMove& asked, const Impact& impact) {
        SeparatedMove distance = asked, share = asked;
        distance.separation.share = 0;
        share.separation.distance = 0;
        const Impact one = distance.impact(), other = share.impact();
        const bool first = one.meets && (!other.meets || one.toi < other.toi || one.start);
        ASSERT_EQ(impact, first ? one : other) << asked;
    });
}

TEST(Separation, DoesNotDependOnTheOrderOfPoints) {
    for_separated(11, [](const SeparatedMove& asked, const Impact& impact) {
        const auto& [p, q, r, s] = asked.move.point;
        const Separation& separation = asked.separation;
        if (asked.move.feature == Feature::vertex_face) {
            ASSERT_EQ(vertex_face(p, r, s, q, separation), impact) << asked;
            ASSERT_EQ(vertex_face(p, r, q, s, separation), impact) << asked;
        } else if (asked.move.feature == Feature::edge_edge) {
            ASSERT_EQ(edge_edge(q, p, r, s, separation), impact) << asked;
            ASSERT_EQ(edge_edge(p, q, s, r, separation), impact) << asked;
            ASSERT_EQ(edge_edge(r, s, p, q, separation), impact) << asked;
        } else if (asked.move.feature == Feature::vertex_edge) {
            ASSERT_EQ(vertex_edge(p, r, q, separation), impact) << asked;
        } else {
            ASSERT_EQ(vertex_vertex(q, p, separation), impact) << asked;
        }
    });
}

TEST(Separation, DoesNotDependOnTheAxes) {
    for_separated(13, [](const SeparatedMove& asked, const Impact& impact) {
        ASSERT_EQ(with_positions(asked, [](Vec3d p) { return Vec3d{p.y, -p.z, p.x}; }).impact(), impact) << asked;
        // Turned by 3, 4, 5 the distances are 5 times as long.
        SeparatedMove turned = with_positions(asked, [](Vec3d p) {
            return Vec3d{3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y, 5 * p.z};
        });
        if (asked.separation.distance == 0.1) return;  // of which the product is rounded
        turned.separation.distance *= 5;
        ASSERT_EQ(turned.impact(), impact) << asked;
    });
}

TEST(Separation, DoesNotDependOnTheUnit) {
    for_separated(17, [](const SeparatedMove& asked, const Impact& impact) {
        for (const double unit : {0x1p-900, 0x1p-3, 0x1p900}) {
            SeparatedMove scaled = with_positions(asked, [&](Vec3d p) { return unit * p; });
            scaled.separation.distance *= unit;
            ASSERT_EQ(scaled.impact(), impact) << asked << " by " << unit;
        }
    });
}

TEST(Separation, DoesNotDependOnTheOrigin) {
    for_separated(19, [](const SeparatedMove& asked, const Impact& impact) {
        const Vec3d shift{0x1p40, -1e6, 0.25};
        ASSERT_EQ(with_positions(asked, [&](Vec3d p) { return p + shift; }).impact(), impact) << asked;
        SeparatedMove moving = asked;
        for (MovingPoint& p : moving.move.point) p.end = p.end + shift;
        ASSERT_EQ(moving.impact(), impact) << asked;
    });
}

TEST(Separation, OfPartOfTheWayIsThatOfTheWhole) {
    for_separated(23, [](const SeparatedMove& asked, const Impact& impact) {
        SeparatedMove half = asked;
        for (MovingPoint& p : half.move.point) p.end = 0.5 * (p.start + p.end);
        const Impact first = half.impact();
        if (impact.meets && impact.toi < 0.5) {
            ASSERT_EQ(first, (Impact{true, 2 * impact.toi, impact.start})) << asked;
        } else if (first.meets) {
            ASSERT_EQ(first.toi, 1) << asked;  // at one half exactly
            ASSERT_EQ(impact.toi, 0.5) << asked;
        }
    });
}

TEST(Separation, IsReachedBackwardsToo) {
    for_separated(29, [](const SeparatedMove& asked, const Impact&) {
        SeparatedMove there = asked, back = asked;
        there.separation.share = back.separation.share = 0;  // of another start
        for (MovingPoint& p : back.move.point) std::swap(p.start, p.end);
        const Impact first = there.impact(), last = back.impact();
        ASSERT_EQ(first.meets, last.meets) << asked;
        ASSERT_TRUE(!first.meets || first.toi <= 1 - last.toi) << asked;
    });
}

TEST(Separation, OfSmallerFeaturesIsThatOfCollapsedOnes) {
    for_separated(31, [](const SeparatedMove& asked, const Impact& impact) {
        const auto& [p, q, r, s] = asked.move.point;
        const Separation& separation = asked.separation;
        if (asked.move.feature == Feature::vertex_edge) {
            ASSERT_EQ(vertex_face(p, q, r, r, separation), impact) << asked;
            ASSERT_EQ(vertex_face(p, r, q, r, separation), impact) << asked;
            ASSERT_EQ(edge_edge(p, p, q, r, separation), impact) << asked;
        } else if (asked.move.feature == Feature::vertex_vertex) {
            ASSERT_EQ(vertex_edge(p, q, q, separation), impact) << asked;
            ASSERT_EQ(vertex_face(p, q, q, q, separation), impact) << asked;
            ASSERT_EQ(edge_edge(p, p, q, q, separation), impact) << asked;
        }
    });
}

TEST(Separation, OfAnEdgeIsThatOfItsHalves) {
    // The point that halves it moves on a straight line, too.
    for_separated(37, [](const SeparatedMove& asked, const Impact&) {
        if (asked.move.feature != Feature::vertex_edge) return;
        const auto& [p, q, r, s] = asked.move.point;
        const Separation separation{asked.separation.distance};
        const MovingPoint middle{0.5 * (q.start + r.start), 0.5 * (q.end + r.end)};
        const Impact left = vertex_edge(p, q, middle, separation), right = vertex_edge(p, middle, r, separation);
        const Impact whole = vertex_edge(p, q, r, separation);
        const bool first = left.meets && (!right.meets || left.toi < right.toi || left.start);
        ASSERT_EQ(whole, first ? left : right) << asked;
    });
}

}  // namespace
}  // namespace crumple
