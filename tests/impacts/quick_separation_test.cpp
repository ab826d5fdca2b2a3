// What float64 decides about separations, against rational arithmetic, where it is hard: at the edge of its bounds.

#include "exact/impact/quick_separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exact/impact/decide_separation.h"
#include "impacts/separated_moves.h"

namespace crumple {
namespace {

FeatureKinds kinds_of(Feature feature) { return static_cast<FeatureKinds>(feature); }

QuickImpact quickly(const SeparatedMove& asked) {
    const auto& points = asked.move.point;
    switch (asked.move.feature) {
        case Feature::vertex_face:
            return quick_separation<FeatureKinds::vertex_face>(points, asked.separation);
        case Feature::edge_edge:
            return quick_separation<FeatureKinds::edge_edge>(points, asked.separation);
        case Feature::vertex_edge:
            return quick_separation<FeatureKinds::vertex_edge>(points, asked.separation);
        case Feature::vertex_vertex:
            break;
    }
    return quick_separation<FeatureKinds::vertex_vertex>(points, asked.separation);
}

/// How many moves were decided, and how.
struct Tally {
    int apart = 0, start = 0, later = 0, unknown = 0;
    int decided() const { return apart + start + later; }
};

/// Fails where float64 is certain of what is wrong.
void check(const SeparatedMove& asked, Tally& tally) {
    const QuickImpact quick = quickly(asked);
    if (quick.verdict == Certainty::unknown) {
        ++tally.unknown;
        return;
    }
    ++(quick.verdict == Certainty::apart ? tally.apart : quick.start ? tally.start : tally.later);
    ASSERT_EQ((Impact{quick.verdict == Certainty::meets, quick.toi, quick.start}), asked.impact()) << asked;
}

/// A number up or down to the n-th neighbour.
double neighbour(double x, int n) {
    const double to = n < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    for (int i = std::abs(n); i > 0; --i) x = std::nextafter(x, to);
    return x;
}

template <class Change>
void change_positions(SeparatedMove& asked, Change change) {
    for (MovingPoint& p : asked.move.point) {
        for (int axis = 0; axis < 3; ++axis) {
            p.start[axis] = change(p.start[axis]);
            p.end[axis] = change(p.end[axis]);
        }
    }
}

/// About their distance at that time.
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

TEST(QuickSeparation, IsRightForDegenerateMoves) {
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 47);
            Tally tally;
            for (int i = 0; i < 400; ++i) check(separated(random, lattice, feature), tally);
            EXPECT_GT(tally.decided(), tally.unknown) << static_cast<int>(feature) << static_cast<int>(lattice);
        }
    }
}

TEST(QuickSeparation, DecidesNearlyAllInGeneralPosition) {
    for (const Feature feature : all_features) {
        RandomMoves random(Lattice::wide, 53);
        Tally tally;
        for (int i = 0; i < 800; ++i) {
            SeparatedMove asked = separated(random, Lattice::wide, feature);
            change_positions(asked, [&](double x) { return x + 1e-3 * random.below(1000); });
            check(asked, tally);
        }
        EXPECT_GT(tally.apart, 50);
        EXPECT_GT(tally.later, 50);
        EXPECT_LT(tally.unknown, 8);
    }
}

TEST(QuickSeparation, IsRightOneUnitBesideTheDistance) {
    // They come within the distance about a float64 number, or at the start, for a moment, or not quite.
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 59);
            Tally tally;
            for (int i = 0; i < 250; ++i) {
                SeparatedMove asked{random(feature), {}};
                const double t = random.below(9) / 8.0, distance = distance_at(asked.move, t);
                asked.separation.distance = neighbour(distance, random.below(7) - 3);
                if (random.below(2) == 0 && distance > 0) {
                    const double start = distance_at(asked.move, 0);
                    if (start > distance) asked.separation = {0, neighbour(distance / start, random.below(7) - 3)};
                }
                // Also at the edge of the range of double words, and beyond it.
                constexpr int exponents[] = {0, 0, -98, 98, -480, -505};
                const int exponent = exponents[random.below(6)];
                change_positions(asked, [&](double x) { return std::ldexp(x, exponent); });
                asked.separation.distance = std::ldexp(asked.separation.distance, exponent);
                check(asked, tally);
            }
            EXPECT_GT(tally.decided(), 0);
        }
    }
}

TEST(QuickSeparation, IsRightFarFromTheOrigin) {
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 61);
            Tally tally;
            for (int i = 0; i < 150; ++i) {
                SeparatedMove asked = separated(random, lattice, feature);
                const int share = 1 + random.below(24), far = random.below(3);
                change_positions(asked, [&](double x) {
                    if (far > 0) x += far == 1 ? 0x1p10 : -0x1p40;
                    return x != 0 && random.below(24) < share ? neighbour(x, random.below(5) - 2) : x;
                });
                check(asked, tally);
            }
            EXPECT_GT(tally.decided(), 0);
        }
    }
}

TEST(QuickSeparation, IsRightWhereItUnderOrOverflows) {
    for (const Feature feature : all_features) {
        for (const int exponent : {-1074, -1070, -1000, -540, -460, -450, -445, -300, -105, -100, -95, 90, 95, 100, 105,
                                   290, 300, 500, 1010}) {
            RandomMoves random(Lattice::small, 67);
            Tally tally;
            for (int i = 0; i < 25; ++i) {
                SeparatedMove asked = separated(random, Lattice::small, feature);
                change_positions(asked, [&](double x) { return neighbour(std::ldexp(x, exponent), random.below(2)); });
                asked.separation.distance = std::ldexp(asked.separation.distance, exponent + random.below(3) - 1);
                check(asked, tally);
            }
            EXPECT_TRUE(std::abs(exponent) >= 95 || tally.decided() > tally.unknown);
        }
    }
}

TEST(QuickSeparation, IsRightWhereMagnitudesDiffer) {
    for (const Feature feature : all_features) {
        RandomMoves random(Lattice::wide, 71);
        Tally tally;
        for (int i = 0; i < 200; ++i) {
            SeparatedMove asked = separated(random, Lattice::wide, feature);
            const int reach = 1 + random.below(60);
            const auto stretched = [&](double x) { return std::ldexp(x, random.below(2 * reach) - reach); };
            change_positions(asked, stretched);
            asked.separation.distance = stretched(asked.separation.distance);
            check(asked, tally);
        }
        EXPECT_GT(tally.decided(), 100);
    }
}

TEST(QuickSeparation, ClaimsNothingOfWhatIsNoNumber) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    RandomMoves random(Lattice::wide, 73);
    for (const Feature feature : all_features) {
        for (const double x : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
            SeparatedMove asked = separated(random, Lattice::wide, feature);
            asked.move.point[static_cast<std::size_t>(random.below(2))].end.y = x;
            EXPECT_EQ(quickly(asked).verdict, Certainty::unknown) << asked;
        }
    }
}

TEST(SurelyFarther, IsNeverSaidOfWhatComesClose) {
    RandomMoves random(Lattice::wide, 79);
    int farther = 0, none = 0;
    for (int i = 0; i < 1'000; ++i) {
        const SeparatedMove asked = separated(random, Lattice::wide, Feature::edge_edge);
        const Impact impact = edge_edge(asked.move.point[0], asked.move.point[1], asked.move.point[2],
                                        asked.move.point[3], Separation{asked.separation.distance, 0});
        const bool surely = surely_farther<FeatureKinds::edge_edge>(asked.move.point, asked.separation.distance);
        ASSERT_FALSE(surely && impact.meets) << asked;
        farther += surely;
        none += !impact.meets;
    }
    EXPECT_GT(none, 200);
    EXPECT_GT(farther, none - 10);
}

TEST(DecideSeparation, IsExact) {
    for (const Feature feature : all_features) {
        for (const Lattice lattice : all_lattices) {
            RandomMoves random(lattice, 83);
            SeparationCounts counts;
            for (int i = 0; i < 60; ++i) {
                const SeparatedMove asked = separated(random, lattice, feature);
                ASSERT_EQ(decide_separation(kinds_of(feature), asked.move.point, asked.separation, counts),
                          asked.impact())
                    << asked;
            }
            EXPECT_LT(counts.rational, 30);
        }
    }
}

}  // namespace
}  // namespace crumple
