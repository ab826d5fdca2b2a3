// Compares float64 decisions about minimum distances with rational arithmetic in hard cases, at the edge of the error
// bounds.

#include "exact/impact/filtered_min_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exact/impact/decide_min_distance.h"
#include "impacts/min_distance_moves.h"

namespace crumple {
namespace {

FeatureKinds kinds_of(Feature feature) { return static_cast<FeatureKinds>(feature); }

FilteredImpact quickly(const MinDistanceMove& query) {
    const auto& points = query.move.point;
    switch (query.move.feature) {
        case Feature::vertex_face:
            return filtered_min_distance<FeatureKinds::vertex_face>(points, query.separation);
        case Feature::edge_edge:
            return filtered_min_distance<FeatureKinds::edge_edge>(points, query.separation);
        case Feature::vertex_edge:
            return filtered_min_distance<FeatureKinds::vertex_edge>(points, query.separation);
        case Feature::vertex_vertex:
            break;
    }
    return filtered_min_distance<FeatureKinds::vertex_vertex>(points, query.separation);
}

/// Numbers of moves by verdict.
struct Tally {
    int apart = 0, start = 0, later = 0, unknown = 0;
    int decided() const { return apart + start + later; }
};

/// Fails if float64 is certain of a wrong verdict.
void check(const MinDistanceMove& query, Tally& tally) {
    const FilteredImpact quick = quickly(query);
    if (quick.verdict == Certainty::unknown) {
        ++tally.unknown;
        return;
    }
    ++(quick.verdict == Certainty::apart ? tally.apart : quick.start ? tally.start : tally.later);
    ASSERT_EQ((Impact{quick.verdict == Certainty::meets, quick.toi, quick.start}), query.impact()) << query;
}

/// Returns the n-th float64 number above x, or below x for negative n.
double neighbour(double x, int n) {
    const double to = n < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    for (int i = std::abs(n); i > 0; --i) x = std::nextafter(x, to);
    return x;
}

template <class Change>
void change_positions(MinDistanceMove& query, Change change) {
    for (MovingPoint& p : query.move.point) {
        for (int axis = 0; axis < 3; ++axis) {
            p.start[axis] = change(p.start[axis]);
            p.end[axis] = change(p.end[axis]);
        }
    }
}

/// Returns the approximate distance of the features at time t.
double distance_at(const Move& move, double t) {
    const auto at = [&](std::size_t i) { return (1 - t) * move.point[i].start + t * move.point[i].end; };
    const Vec3d p = at(0), q = at(1), r = at(2), s = at(3);
    const auto subtract = [](const Vec3d& x, const Vec3d& y) { return x - y; };
    const auto length = [&]<FeatureKinds kinds>() {
        const auto x = detail::difference<kinds>(p, q, r, s, subtract);
        const Vec3d g = detail::at(x, detail::closest<kinds>(x));
        return std::sqrt(dot(g, g));
    };
    switch (move.feature) {
        case Feature::vertex_face:
            return length.operator()<FeatureKinds::vertex_face>();
        case Feature::edge_edge:
            return length.operator()<FeatureKinds::edge_edge>();
        case Feature::vertex_edge:
            return length.operator()<FeatureKinds::vertex_edge>();
        case Feature::vertex_vertex:
            break;
    }
    return length.operator()<FeatureKinds::vertex_vertex>();
}

TEST(FilteredMinDistance, is_right_or_undecided_for_degenerate_moves) {
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 47);
            Tally tally;
            for (int i = 0; i < 400; ++i) check(separated(random, lattice, feature), tally);
            EXPECT_GT(tally.decided(), tally.unknown) << static_cast<int>(feature) << static_cast<int>(lattice);
        }
    }
}

TEST(FilteredMinDistance, decides_nearly_all_moves_in_general_position) {
    for (const Feature feature : all_features) {
        RandomMoves random(Lattice::wide, 53);
        Tally tally;
        for (int i = 0; i < 800; ++i) {
            MinDistanceMove query = separated(random, Lattice::wide, feature);
            change_positions(query, [&](double x) { return x + 1e-3 * random.below(1000); });
            check(query, tally);
        }
        EXPECT_GT(tally.apart, 50);
        EXPECT_GT(tally.later, 50);
        EXPECT_LT(tally.unknown, 8);
    }
}

TEST(FilteredMinDistance, is_right_or_undecided_within_a_few_ulps_of_the_distance) {
    // The minimum distance is the distance of the features at time t, up to a few units in the last place. So they come
    // within it near t, or earlier, or at the start, or for an instant only, or just not.
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 59);
            Tally tally;
            for (int i = 0; i < 250; ++i) {
                MinDistanceMove query{random(feature), {}};
                const double t = random.below(9) / 8.0, distance = distance_at(query.move, t);
                query.separation.distance = neighbour(distance, random.below(7) - 3);
                if (random.below(2) == 0 && distance > 0) {
                    const double start = distance_at(query.move, 0);
                    if (start > distance) query.separation = {0, neighbour(distance / start, random.below(7) - 3)};
                }
                // Some moves are at the edge of the range of double words, or beyond it.
                constexpr int exponents[] = {0, 0, -98, 98, -480, -505};
                const int exponent = exponents[random.below(6)];
                change_positions(query, [&](double x) { return std::ldexp(x, exponent); });
                query.separation.distance = std::ldexp(query.separation.distance, exponent);
                check(query, tally);
            }
            EXPECT_GT(tally.decided(), 0);
        }
    }
}

TEST(FilteredMinDistance, is_right_or_undecided_far_from_the_origin) {
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 61);
            Tally tally;
            for (int i = 0; i < 150; ++i) {
                MinDistanceMove query = separated(random, lattice, feature);
                const int share = 1 + random.below(24), far = random.below(3);
                change_positions(query, [&](double x) {
                    if (far > 0) x += far == 1 ? 0x1p10 : -0x1p40;
                    return x != 0 && random.below(24) < share ? neighbour(x, random.below(5) - 2) : x;
                });
                check(query, tally);
            }
            EXPECT_GT(tally.decided(), 0);
        }
    }
}

TEST(FilteredMinDistance, is_right_or_undecided_where_products_underflow_or_overflow) {
    for (const Feature feature : all_features) {
        for (const int exponent : {-1074, -1070, -1000, -540, -460, -450, -445, -300, -105, -100, -95, 90, 95, 100, 105,
                                   290, 300, 500, 1010}) {
            RandomMoves random(Lattice::small, 67);
            Tally tally;
            for (int i = 0; i < 25; ++i) {
                MinDistanceMove query = separated(random, Lattice::small, feature);
                change_positions(query, [&](double x) { return neighbour(std::ldexp(x, exponent), random.below(2)); });
                query.separation.distance = std::ldexp(query.separation.distance, exponent + random.below(3) - 1);
                check(query, tally);
            }
            EXPECT_TRUE(std::abs(exponent) >= 95 || tally.decided() > tally.unknown);
        }
    }
}

TEST(FilteredMinDistance, is_right_or_undecided_for_mixed_magnitudes) {
    for (const Feature feature : all_features) {
        RandomMoves random(Lattice::wide, 71);
        Tally tally;
        for (int i = 0; i < 200; ++i) {
            MinDistanceMove query = separated(random, Lattice::wide, feature);
            const int spread = 1 + random.below(60);
            const auto stretched = [&](double x) { return std::ldexp(x, random.below(2 * spread) - spread); };
            change_positions(query, stretched);
            query.separation.distance = stretched(query.separation.distance);
            check(query, tally);
        }
        EXPECT_GT(tally.decided(), 100);
    }
}

TEST(FilteredMinDistance, is_undecided_for_nan_and_infinity) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    RandomMoves random(Lattice::wide, 73);
    for (const Feature feature : all_features) {
        for (const double x : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
            for (std::size_t i = 0; i < 6 * points_of(feature); ++i) {
                MinDistanceMove query = separated(random, Lattice::wide, feature);
                MovingPoint& p = query.move.point[i / 6];
                (i % 2 == 0 ? p.start : p.end)[static_cast<int>(i / 2 % 3)] = x;
                EXPECT_EQ(quickly(query).verdict, Certainty::unknown) << query;
            }
        }
    }
}

TEST(EdgeEdgeFilter, edges_that_come_within_the_min_distance_are_not_rejected) {
    RandomMoves random(Lattice::wide, 79);
    int farther = 0, none = 0;
    for (int i = 0; i < 1'000; ++i) {
        const MinDistanceMove query = separated(random, Lattice::wide, Feature::edge_edge);
        const Impact impact = edge_edge(query.move.point[0], query.move.point[1], query.move.point[2],
                                        query.move.point[3], MinDistance{query.separation.distance, 0});
        const bool surely = surely_farther<FeatureKinds::edge_edge>(query.move.point, query.separation.distance);
        ASSERT_FALSE(surely && impact.meets) << query;
        farther += surely;
        none += !impact.meets;
    }
    EXPECT_GT(none, 200);
    EXPECT_GT(farther, none - 10);
}

TEST(DecidedMinDistance, agrees_with_rational_arithmetic) {
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 83);
            MinDistanceCounts counts;
            for (int i = 0; i < 60; ++i) {
                const MinDistanceMove query = separated(random, lattice, feature);
                ASSERT_EQ(decide_min_distance(kinds_of(feature), query.move.point, query.separation, counts),
                          query.impact())
                    << query;
            }
            EXPECT_LT(counts.rational, 30);
        }
    }
}

}  // namespace
}  // namespace crumple
