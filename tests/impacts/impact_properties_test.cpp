// Checks that some changes of a move leave its impact as it is, and that others have the expected effect.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "exact/intersection/exact_intersection.h"
#include "impacts/random_moves.h"
#include "rounds.h"

namespace crumple {
namespace {

const int rounds = scaled_rounds(150);

/// Calls `check` with many moves, and fails unless some of each kind meet and some do not.
template <class Check>
void for_moves(std::uint64_t seed, Check check) {
    for (const Feature feature : all_features) {
        int hits = 0, all = 0;
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, seed);
            for (int i = 0; i < rounds; ++i, ++all) {
                const Move move = random(feature);
                const Impact impact = move.impact();
                hits += impact.meets;
                check(move, impact);
                if (testing::Test::HasFatalFailure()) return;
            }
        }
        EXPECT_GT(hits, all / 100);
        EXPECT_LT(hits, all);
    }
}

template <class Change>
Move with_positions(Move move, Change change) {
    for (MovingPoint& p : move.point) p = {change(p.start), change(p.end)};
    return move;
}

TEST(Impact, does_not_depend_on_the_order_of_points) {
    for_moves(3, [](const Move& move, const Impact& impact) {
        const auto& [p, q, r, s] = move.point;
        if (move.feature == Feature::vertex_face) {
            ASSERT_EQ(vertex_face(p, r, s, q), impact) << move;
            ASSERT_EQ(vertex_face(p, s, q, r), impact) << move;
            ASSERT_EQ(vertex_face(p, r, q, s), impact) << move;
        } else if (move.feature == Feature::edge_edge) {
            ASSERT_EQ(edge_edge(q, p, r, s), impact) << move;
            ASSERT_EQ(edge_edge(p, q, s, r), impact) << move;
            ASSERT_EQ(edge_edge(r, s, p, q), impact) << move;
            ASSERT_EQ(edge_edge(s, r, q, p), impact) << move;
        } else if (move.feature == Feature::vertex_edge) {
            ASSERT_EQ(vertex_edge(p, r, q), impact) << move;
        } else {
            ASSERT_EQ(vertex_vertex(q, p), impact) << move;
        }
    });
}

TEST(Impact, does_not_depend_on_the_axes) {
    for_moves(5, [](const Move& move, const Impact& impact) {
        ASSERT_EQ(with_positions(move, [](Vec3d p) { return Vec3d{p.y, p.z, p.x}; }).impact(), impact) << move;
        ASSERT_EQ(with_positions(move, [](Vec3d p) { return Vec3d{p.y, p.x, -p.z}; }).impact(), impact) << move;
        // An affine map changes neither whether nor when features meet.
        ASSERT_EQ(with_positions(move,
                                 [](Vec3d p) {
                                     return Vec3d{p.x + 3 * p.y, p.y, 2 * p.z - p.x};
                                 })
                      .impact(),
                  impact)
            << move;
    });
}

TEST(Impact, does_not_depend_on_the_unit) {
    for_moves(7, [](const Move& move, const Impact& impact) {
        for (const double unit : {0x1p-1074, 0x1p-1022, 0x1p1017})
            ASSERT_EQ(with_positions(move, [&](Vec3d p) { return unit * p; }).impact(), impact)
                << move << " by " << unit;
    });
}

TEST(Impact, does_not_depend_on_the_origin) {
    for_moves(11, [](const Move& move, const Impact& impact) {
        const Vec3d shift{0x1p52, -1e6, 0.25};
        ASSERT_EQ(with_positions(move, [&](Vec3d p) { return p + shift; }).impact(), impact) << move;
        // A common motion, too, changes nothing.
        Move moving = move;
        for (MovingPoint& p : moving.point) p.end = p.end + shift;
        ASSERT_EQ(moving.impact(), impact) << move;
    });
}

TEST(Impact, reversed_move_has_an_impact_iff_the_move_has_one) {
    for_moves(13, [](const Move& move, const Impact& impact) {
        Move back = move;
        for (MovingPoint& p : back.point) std::swap(p.start, p.end);
        const Impact last = back.impact();
        ASSERT_EQ(last.meets, impact.meets) << move;
        // The first contact is no later than the last, which is the first of the reversed move.
        ASSERT_TRUE(!impact.meets || impact.toi <= 1 - last.toi) << move;
    });
}

TEST(Impact, half_of_the_move_doubles_the_time_of_impact) {
    // The half move takes all of the time, so an impact comes at twice the time.
    for_moves(17, [](const Move& move, const Impact& impact) {
        Move half = move;
        for (MovingPoint& p : half.point) p.end = 0.5 * (p.start + p.end);
        const Impact first = half.impact();
        if (impact.meets && impact.toi < 0.5) {
            ASSERT_EQ(first, (Impact{true, 2 * impact.toi, impact.start})) << move;
        } else if (first.meets) {
            ASSERT_EQ(first.toi, 1) << move;  // the whole move has its impact at 1/2
            ASSERT_EQ(impact.toi, 0.5) << move;
        }
    });
}

TEST(Impact, collapsed_features_act_like_smaller_ones_and_parts_meet_no_earlier) {
    for_moves(19, [](const Move& move, const Impact& impact) {
        const auto& [p, q, r, s] = move.point;
        if (move.feature == Feature::vertex_edge) {
            ASSERT_EQ(vertex_face(p, q, r, r), impact) << move;
            ASSERT_EQ(vertex_face(p, r, q, r), impact) << move;
            ASSERT_EQ(edge_edge(p, p, q, r), impact) << move;
        } else if (move.feature == Feature::vertex_vertex) {
            ASSERT_EQ(vertex_edge(p, q, q), impact) << move;
            ASSERT_EQ(vertex_face(p, q, q, q), impact) << move;
            ASSERT_EQ(edge_edge(p, p, q, q), impact) << move;
        } else if (move.feature == Feature::vertex_face) {
            for (const Impact& edge : {vertex_edge(p, q, r), vertex_edge(p, r, s), vertex_edge(p, s, q)}) {
                if (!edge.meets) continue;
                ASSERT_TRUE(impact.meets) << move;
                ASSERT_LE(impact.toi, edge.toi) << move;
            }
        } else {
            for (const Impact& end :
                 {vertex_edge(p, r, s), vertex_edge(q, r, s), vertex_edge(r, p, q), vertex_edge(s, p, q)}) {
                if (!end.meets) continue;
                ASSERT_TRUE(impact.meets) << move;
                ASSERT_LE(impact.toi, end.toi) << move;
            }
        }
    });
}

/// True if the features touch at one end of the move, by the exact intersection of degenerate triangles.
bool touch(const Move& move, Vec3d MovingPoint::*at) {
    const auto& [p, q, r, s] = move.point;
    const auto triangle = [&](const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, std::int32_t first) {
        return Triangle{{a.*at, b.*at, c.*at}, {first, first + 1, first + 2}};
    };
    const auto [a, b] = move.feature == Feature::vertex_face   ? std::pair(triangle(p, p, p, 0), triangle(q, r, s, 3))
                        : move.feature == Feature::edge_edge   ? std::pair(triangle(p, q, q, 0), triangle(r, s, s, 3))
                        : move.feature == Feature::vertex_edge ? std::pair(triangle(p, p, p, 0), triangle(q, r, r, 3))
                                                               : std::pair(triangle(p, p, p, 0), triangle(q, q, q, 3));
    return intersect_rationally(a, b).collides;
}

TEST(Impact, start_flag_is_set_iff_features_touch_at_the_start) {
    for_moves(23, [](const Move& move, const Impact& impact) {
        ASSERT_EQ(impact.start, touch(move, &MovingPoint::start)) << move;
        ASSERT_TRUE(!impact.start || impact.toi == 0) << move;
        ASSERT_TRUE(!touch(move, &MovingPoint::end) || impact.meets) << move;
    });
}

TEST(Impact, static_features_have_an_impact_iff_they_touch) {
    for_moves(29, [](const Move& move, const Impact&) {
        Move still = move;
        for (MovingPoint& p : still.point) p.end = p.start;
        const bool touching = touch(move, &MovingPoint::start);
        ASSERT_EQ(still.impact(), (Impact{touching, 0, touching})) << move;
    });
}

// Gives each coordinate its own magnitude, from nearly the whole range of float64. Impacts are not rare, since many
// coordinates are 0.
TEST(Impact, moves_of_mixed_magnitudes_meet_iff_they_meet_reordered_or_reversed) {
    for (const Feature feature : {Feature::vertex_face, Feature::edge_edge}) {
        RandomMoves random(Lattice::tiny, 37);
        int hits = 0;
        for (int i = 0; i < 12; ++i) {
            const auto stretched = [&](Vec3d p) {
                for (int axis = 0; axis < 3; ++axis) p[axis] = std::ldexp(p[axis], random.below(2'000) - 1'000);
                return p;
            };
            const Move move = with_positions(random(feature), stretched);
            const Impact impact = move.impact();
            hits += impact.meets;
            Move back = move;
            for (MovingPoint& p : back.point) std::swap(p.start, p.end);
            ASSERT_EQ(back.impact().meets, impact.meets) << move;
            ASSERT_EQ(impact.start, touch(move, &MovingPoint::start)) << move;
            const auto& [p, q, r, s] = move.point;
            ASSERT_EQ(feature == Feature::vertex_face ? vertex_face(p, s, r, q) : edge_edge(s, r, p, q), impact)
                << move;
        }
        EXPECT_GT(hits, 0);
        EXPECT_LT(hits, 12);
    }
}

}  // namespace
}  // namespace crumple
