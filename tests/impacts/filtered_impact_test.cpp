// Compares float64 decisions of impacts with rational arithmetic in hard cases, at the edge of the error bounds.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "impacts/decided_moves.h"
#include "impacts/random_moves.h"

namespace crumple {
namespace {

constexpr std::array quick_features{Feature::vertex_face, Feature::edge_edge};

/// Numbers of moves by verdict.
struct Tally {
    int apart = 0, meets = 0, unknown = 0;
    int decided() const { return apart + meets; }
};

/// Fails if float64 is certain of a wrong verdict.
void check(const Move& move, Tally& tally) {
    const FilteredImpact quick = quickly(move);
    if (quick.verdict == Certainty::unknown) {
        ++tally.unknown;
        ASSERT_FALSE(surely_apart(move)) << move;
        return;
    }
    ++(quick.verdict == Certainty::meets ? tally.meets : tally.apart);
    ASSERT_EQ((Impact{quick.verdict == Certainty::meets, quick.toi, quick.start}), move.impact()) << move;
    ASSERT_FALSE(surely_apart(move) && quick.verdict != Certainty::apart) << move;
}

/// Returns the n-th float64 number above x, or below x for negative n.
double nudged(double x, int n) {
    const double to = n < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    for (int i = std::abs(n); i > 0; --i) x = std::nextafter(x, to);
    return x;
}

template <class Change>
void change_coordinates(Move& move, Change change) {
    for (MovingPoint& p : move.point) {
        for (int axis = 0; axis < 3; ++axis) {
            p.start[axis] = change(p.start[axis]);
            p.end[axis] = change(p.end[axis]);
        }
    }
}

TEST(FilteredImpact, is_right_or_undecided_for_degenerate_moves) {
    for (const Feature feature : quick_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 23);
            Tally tally;
            for (int i = 0; i < 1500; ++i) check(random(feature), tally);
            EXPECT_GT(tally.decided(), 0);
            if (lattice == Lattice::wide) {
                EXPECT_GT(tally.meets, 20);
                EXPECT_LT(tally.unknown, 30);
            }
        }
    }
}

TEST(FilteredImpact, is_right_or_undecided_for_degenerate_moves_changed_by_up_to_two_ulps) {
    // In most moves with small integers the features touch on the border of one of them, at the start or the end, or
    // for an instant only, or nearly do so.
    for (const Feature feature : quick_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 29);
            Tally tally;
            for (int i = 0; i < 400; ++i) {
                Move move = random(feature);
                // Moves the points far from the origin in some rounds, and some or all coordinates by up to two units
                // in the last place.
                const int share = 1 + random.below(24), far = random.below(3);
                change_coordinates(move, [&](double x) {
                    if (far > 0) x += far == 1 ? 0x1p10 : -0x1p40;
                    return random.below(24) < share ? nudged(x, random.below(5) - 2) : x;
                });
                check(move, tally);
            }
            EXPECT_GT(tally.decided(), 0);
        }
    }
}

TEST(FilteredImpact, is_right_or_undecided_where_products_underflow_or_overflow) {
    for (const Feature feature : quick_features) {
        for (const Lattice lattice : all_lattices) {
            for (const int exponent : {-1074, -1070, -1000, -520, -345, -340, -330, -320, -300, 290, 299, 301, 1015}) {
                RandomMoves random(lattice, 31);
                Tally tally;
                for (int i = 0; i < 15; ++i) {
                    Move move = random(feature);
                    change_coordinates(move,
                                       [&](double x) { return nudged(std::ldexp(x, exponent), random.below(2)); });
                    check(move, tally);
                }
            }
        }
    }
}

TEST(FilteredImpact, is_right_or_undecided_for_mixed_magnitudes) {
    for (const Feature feature : quick_features) {
        RandomMoves random(Lattice::wide, 37);
        Tally tally;
        for (int i = 0; i < 400; ++i) {
            Move move = random(feature);
            const int spread = 1 + random.below(80);
            change_coordinates(move, [&](double x) { return std::ldexp(x, random.below(2 * spread) - spread); });
            check(move, tally);
        }
        EXPECT_GT(tally.apart, 100);
    }
}

TEST(FilteredImpact, is_right_or_undecided_for_volumes_with_nearly_double_roots) {
    // The volume (the determinant of the four points) is 0 when the vertex is in the plane of the face, and also when
    // the face collapses to a segment. Here these two times may be equal or close to each other.
    RandomMoves random(Lattice::wide, 41);
    Tally tally;
    for (int i = 0; i < 2000; ++i) {
        const double turn = (1 + random.below(999)) * 0x1p-10, gap = std::ldexp(random.below(9) - 4, -random.below(60));
        const auto beside = [&](double x, double at) { return Vec3d{x, random.below(7) - 3., x * at}; };
        Move move{Feature::vertex_face, {}};
        // The face stays in the plane z = x s, and s goes from -turn to 1 - turn. The vertex crosses this plane, at t =
        // 1/2 if `gap` is 0.
        const double x = random.below(5) - 2.;
        move.point[0] = {{x, 0, gap - x * turn * turn}, {x, 0, gap + x * (1 - turn) * (1 - turn)}};
        for (std::size_t corner = 1; corner < 4; ++corner) {
            const double far = corner == 1 ? -3. : 1 + random.below(4);
            move.point[corner] = {beside(far, -turn), beside(far, 1 - turn)};
        }
        check(move, tally);
    }
    EXPECT_GT(tally.meets, 50);
    EXPECT_GT(tally.apart, 50);
}

/// Returns a multiple of 2^-bits between -4 and 4.
double with_bits(RandomMoves& random, int bits) {
    return random.below(8) - 4 + std::ldexp(random.below(1 << 15), -15) + std::ldexp(random.below(1 << 15), -bits);
}

TEST(FilteredImpact, is_right_or_undecided_for_contact_at_exactly_half_of_the_move) {
    // At t = 1/2 the vertex is in the face, or on an edge of it. Products of three coordinates have more bits than a
    // double word.
    RandomMoves random(Lattice::tiny, 61);
    Tally tally;
    for (int i = 0; i < 1000; ++i) {
        const auto position = [&] {
            return Vec3d{with_bits(random, 42), with_bits(random, 42), with_bits(random, 42)};
        };
        Move move{Feature::vertex_face, {}};
        auto& [p, a, b, c] = move.point;
        for (MovingPoint* x : {&a, &b, &c}) *x = {position(), position()};
        const auto twice = [](const MovingPoint& x) { return x.start + x.end; };
        p.start = position();
        p.end = (i % 4 == 0 ? 0.5 * (twice(a) + twice(b)) : 0.25 * (twice(a) + twice(b) + 2 * twice(c))) - p.start;
        check(move, tally);
    }
}

TEST(FilteredImpact, times_of_impact_next_to_one_half_are_rounded_down_or_undecided) {
    // At t = 1/2 the face is in a plane through the origin. The vertex is above or below the origin by 2^exponent. The
    // plane is steep, so that the volume is a small difference of large products.
    RandomMoves random(Lattice::tiny, 67);
    Tally tally;
    for (int exponent = -40; exponent > -115; --exponent) {
        for (const double side : {-1, 1}) {
            for (int i = 0; i < 20; ++i) {
                const auto corner = [&](double x, double y) {
                    const auto sheared = [&](double z) {
                        const Vec3d p{x + with_bits(random, 40), y + with_bits(random, 40), z};
                        return Vec3d{p.x, p.y, p.z + 7 * p.x - 5 * p.y};
                    };
                    const double z = 1 + random.below(1 << 20) * 0x1p-20;
                    return MovingPoint{sheared(z), sheared(-z)};
                };
                const Vec3d still{0, 0, side * std::ldexp(1, exponent)};
                check({Feature::vertex_face, {MovingPoint{still, still}, corner(-9, -9), corner(9, -9), corner(0, 15)}},
                      tally);
            }
        }
        if (exponent == -85) {
            EXPECT_EQ(tally.unknown, 0);
        }
    }
    EXPECT_GT(tally.meets, 1'500);
    EXPECT_GT(tally.unknown, 0) << "not at the edge";
}

TEST(FilteredImpact, is_right_or_undecided_within_rounding_errors_of_a_border) {
    // Contact at a random time t on the border of a feature, or at a corner, as nearly as rounding allows; in most
    // rounds a random, often tiny distance beside the border.
    RandomMoves random(Lattice::tiny, 89);
    for (const Feature feature : quick_features) {
        Tally tally;
        for (int i = 0; i < 3000; ++i) {
            const auto position = [&] {
                return Vec3d{with_bits(random, 50), with_bits(random, 50), with_bits(random, 50)};
            };
            const double speed = std::ldexp(1, -random.below(30)), t = random.below(1 << 30) * 0x1p-30;
            Move move{feature, {}};
            for (MovingPoint& p : move.point) {
                p.start = position();
                p.end = p.start + speed * position();
            }
            const auto at = [&](std::size_t k) { return (1 - t) * move.point[k].start + t * move.point[k].end; };
            const double away = i % 4 == 0 ? 0 : std::ldexp(random.below(8) - 4, -random.below(60));
            const double far = i % 3 == 0 ? away : random.below(1 << 20) * 0x1p-20;
            const bool face = feature == Feature::vertex_face;
            const Vec3d corner = at(face ? 1 : 2), next = at(face ? 2 : 3);
            Vec3d contact = corner + far * (next - corner);
            // At time t the vertex is at `contact`, or the first edge ends there.
            contact = face ? contact + away * (at(3) - corner) : at(1) + (1 + away) * (contact - at(1));
            MovingPoint& p = move.point[0];
            if (t > 0.5) {
                p.end = p.start + 1 / t * (contact - p.start);
            } else {
                p.start = p.end + 1 / (1 - t) * (contact - p.end);
            }
            check(move, tally);
        }
        EXPECT_GT(tally.meets, 300);
        EXPECT_GT(tally.apart, 300);
        EXPECT_GT(tally.unknown, 300) << "not at the edge";
    }
}

TEST(FilteredImpact, is_right_or_undecided_for_edges_that_are_collinear_at_contact) {
    // At t = 5/16 the edges are on one line, and an end of one is at an end of the other.
    RandomMoves random(Lattice::tiny, 71);
    Tally tally;
    for (int i = 0; i < 1000; ++i) {
        const auto position = [&](int bits) {
            return Vec3d{with_bits(random, bits), with_bits(random, bits), with_bits(random, bits)};
        };
        const Vec3d along = position(30);
        const std::array<int, 4> place{-1 - random.below(3), 0, 0, random.below(7) - 2};
        Move move{Feature::edge_edge, {}};
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3d velocity = position(45), middle = static_cast<double>(place[k]) * along;
            move.point[k] = {middle - 5. * velocity, middle + 11. * velocity};
        }
        check(move, tally);
    }
}

TEST(FilteredImpact, decides_most_moves_with_three_points_in_an_axis_aligned_plane) {
    // Three points stay in an axis-aligned plane, exactly or nearly, so that the features can only meet on one line.
    for (const bool exact : {true, false}) {
        for (const Feature feature : quick_features) {
            RandomMoves random(Lattice::wide, 79);
            Tally tally, joined;
            for (int i = 0; i < 3000; ++i) {
                Move move = random(feature);
                const std::size_t other = static_cast<std::size_t>(random.below(4));
                const int axis = random.below(3);
                const MovingPoint& leader = move.point[(other + 1) % 4];
                for (std::size_t k = 0; k < 4; ++k) {
                    if (k == other) continue;
                    move.point[k].start[axis] = leader.start[axis];
                    move.point[k].end[axis] = leader.end[axis];
                }
                // The other point may join the plane.
                if (i % 5 == 0) move.point[other].end[axis] = leader.end[axis];
                if (i % 10 == 0) move.point[other].start[axis] = leader.start[axis];
                if (!exact) {
                    double& x = move.point[static_cast<std::size_t>(random.below(4))].end[random.below(3)];
                    x = nudged(x, 2 * random.below(2) - 1);
                }
                check(move, i % 5 == 0 ? joined : tally);
            }
            EXPECT_GT(tally.meets, 40);
            EXPECT_LT(tally.unknown, exact ? 100 : 250);
        }
    }
}

TEST(FilteredImpact, coincident_vertices_are_an_impact_at_the_start) {
    for (const Feature feature : quick_features) {
        RandomMoves random(Lattice::wide, 43);
        for (int i = 0; i < 12; ++i) {
            Move move = random(feature);
            const std::size_t one = feature == Feature::vertex_face ? 0 : static_cast<std::size_t>(i / 2 % 2);
            const std::size_t other = feature == Feature::vertex_face ? static_cast<std::size_t>(1 + i % 3)
                                                                      : static_cast<std::size_t>(2 + i % 2);
            move.point[one].start = move.point[other].start;
            const FilteredImpact quick = quickly(move);
            EXPECT_EQ(quick.verdict, Certainty::meets) << move;
            EXPECT_TRUE(quick.start && quick.toi == 0) << move;
        }
    }
}

TEST(FilteredImpact, features_that_slide_side_by_side_in_one_plane_are_apart) {
    // A point beside a face in the same plane; all points slide in the plane.
    const auto slide = [](double x, double y) { return MovingPoint{{x, y, 0.3}, {x + 0.1, y - 0.7, 0.3}}; };
    const Move beside{Feature::vertex_face, {slide(1.1, 1.2), slide(0, 0), slide(2, 0), slide(0.1, 2)}};
    EXPECT_EQ(quickly(beside).verdict, Certainty::apart);
    const Move edges{Feature::edge_edge, {slide(0, 0), slide(2, 0), slide(1, 0.1), slide(1.5, 3)}};
    EXPECT_EQ(quickly(edges).verdict, Certainty::apart);
}

TEST(FilteredImpact, is_undecided_for_nan_and_infinity) {
    RandomMoves random(Lattice::wide, 47);
    for (const Feature feature : quick_features) {
        for (const double odd : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()}) {
            for (std::size_t i = 0; i < 24; ++i) {
                Move move = random(feature);
                MovingPoint& p = move.point[i / 6];
                (i % 2 == 0 ? p.start : p.end)[static_cast<int>(i / 2 % 3)] = odd;
                EXPECT_EQ(quickly(move).verdict, Certainty::unknown) << move;
                EXPECT_FALSE(surely_apart(move)) << move;
            }
        }
    }
}

TEST(DecidedImpact, contact_at_the_start_is_decided_mostly_without_rationals) {
    for (const Feature feature : quick_features) {
        RandomMoves random(Lattice::wide, 73);
        ImpactCounts counts;
        for (int i = 0; i < 300; ++i) {
            Move move = random(feature);
            auto& [p, q, r, s] = move.point;
            if (feature == Feature::vertex_face) {  // inside, on a corner, on an edge
                p.start = i % 3 == 0 ? 0.25 * (q.start + 2. * r.start + s.start)
                                     : 0.25 * (q.start + 3. * (i % 3 == 1 ? q.start : s.start));
            } else {  // crossing, end on the other edge, end on its line beside it
                const Vec3d middle = 0.5 * (r.start + s.start);
                p.start = i % 3 == 0 ? 2. * middle - q.start : i % 3 == 1 ? middle : 2. * r.start - s.start;
            }
            ASSERT_EQ(decide(move, counts), move.impact()) << move;
            ASSERT_TRUE(move.impact().start || (feature == Feature::edge_edge && i % 3 == 2)) << move;
        }
        EXPECT_LT(counts.exact, 110);
    }
}

TEST(DecidedImpact, slides_in_axis_aligned_planes_hardly_need_rationals) {
    for (const Feature feature : quick_features) {
        RandomMoves random(Lattice::level, 79);
        ImpactCounts counts;
        int meets = 0, in_motion = 0;
        for (int i = 0; i < 300; ++i) {
            Move move = random(feature);
            const auto& first = move.point[0];
            for (int axis = 0; axis < 3; ++axis) {
                const bool level = std::all_of(move.point.begin(), move.point.end(), [&](const MovingPoint& p) {
                    return p.start[axis] == first.start[axis] && p.end[axis] == first.end[axis];
                });
                if (level) continue;
                for (MovingPoint& p : move.point) {
                    p.start[axis] += 0.001 * random.below(1000);
                    p.end[axis] += 0.001 * random.below(1000);
                }
            }
            const Impact impact = decide(move, counts);
            ASSERT_EQ(impact, move.impact()) << move;
            meets += impact.meets;
            in_motion += impact.meets && !impact.start;
        }
        EXPECT_GT(in_motion, 50);
        EXPECT_GT(300 - meets, 30);
        EXPECT_LT(counts.exact, 3);
    }
}

TEST(DecidedImpact, agrees_with_rational_arithmetic) {
    for (const Feature feature : quick_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 53);
            ImpactCounts counts;
            for (int i = 0; i < 150; ++i) {
                Move move = random(feature);
                if (i % 10 == 0) change_coordinates(move, [](double x) { return std::ldexp(x, 700); });
                ASSERT_EQ(decide(move, counts), move.impact()) << move;
            }
            EXPECT_GE(counts.exact, 15);
            EXPECT_GE(counts.roots, counts.exact);
            EXPECT_LE(counts.roots, 150);
        }
    }
}

}  // namespace
}  // namespace crumple
