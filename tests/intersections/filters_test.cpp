// Tests of the filters of `narrow` for one pair: what they are certain of is true, and they are certain of most pairs.

#include "filters/intersection/pair_filters.h"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>
#include <vector>

#include "exact/intersection/decide_intersection.h"
#include "geometry/ball.h"
#include "geometry/predicates.h"
#include "geometry/random_pairs.h"

namespace crumple {
namespace {

/// Pair as input of the filters: vertices divided by a power of two, so that none exceeds 1, in rows by vertex id, and
/// records in a leaf that holds no other triangle.
struct FilteredPair {
    std::vector<float> rows32;
    std::vector<double> rows64;
    Record a, b;
    float reach = 0;

    FilteredPair(const TrianglePair& pair, Vec3f origin, float big, bool float32) : rows32(4 * 32), rows64(4 * 32) {
        double most = 0;
        for (const Triangle& t : {pair.a, pair.b}) {
            for (const Vec3d& p : t.point) most = std::max(most, largest(abs(p)));
        }
        int exponent = 0;
        std::frexp(most, &exponent);
        for (const Triangle& t : {pair.a, pair.b}) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto row = 4 * static_cast<std::size_t>(t.vertex[k]);
                for (int axis = 0; axis < 3; ++axis) {
                    const double x = std::ldexp(t.point[k][axis], -exponent);
                    rows64[row + static_cast<std::size_t>(axis)] = x;
                    rows32[row + static_cast<std::size_t>(axis)] = static_cast<float>(x);
                }
            }
        }
        if (!float32) rows32.clear();
        LeafFrame frame{origin, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, big};
        const auto member = [&](const Triangle& t) {
            const Vec3d p[3] = {points()[t.vertex[0]], points()[t.vertex[1]], points()[t.vertex[2]]};
            const InFrame<3> member(p, frame);
            reach = std::max(reach, member.counted_extent());
            return record_of(p, t.vertex.data(), member);
        };
        a = member(pair.a);
        b = member(pair.b);
        scale_plane(a, plane_scale(reach));
        scale_plane(b, plane_scale(reach));
    }
    PointRows points() const {
        return rows32.empty() ? PointRows{nullptr, rows64.data()} : PointRows{rows32.data(), nullptr};
    }
};

bool expected(const TrianglePair& pair, const NarrowPolicy& policy) {
    DecisionCounts counts;
    return collide(pair.a, pair.b, policy.skip_adjacent ? Neighbours::skip : Neighbours::geometric,
                   policy.proper ? IntersectionKind::proper : IntersectionKind::all, counts);
}

struct Case {
    Kind kind;
    bool float32;      ///< the kind's coordinates are float32 numbers, and filtered as such
    double undecided;  ///< highest share of pairs that the filters may leave undecided
};

class Filters : public testing::TestWithParam<Case> {
   protected:
    RandomPairs random{GetParam().kind, 53};
    static constexpr int rounds = 20'000;
    static constexpr float everything = std::numeric_limits<float>::max();
};

TEST_P(Filters, are_right_where_they_are_certain) {
    int undecided = 0;
    for (int i = 0; i < rounds; ++i) {
        const TrianglePair pair = random();
        const auto at = [&] { return static_cast<float>(random.real(-1, 1)); };
        const Vec3f origin = i % 2 ? Vec3f{at(), at(), at()} : Vec3f{};
        // In some rounds, triangles that extend beyond 0.5 are "big" members of the leaf (LeafFrame::big).
        const float big = i % 8 ? everything : 0.5f;
        const FilteredPair filtered(pair, origin, big, GetParam().float32);
        for (const NarrowPolicy policy : {NarrowPolicy{false, false}, {true, false}, {false, true}}) {
            for (const bool swapped : {false, true}) {
                const Record &a = swapped ? filtered.b : filtered.a, &b = swapped ? filtered.a : filtered.b;
                const Verdict verdict = filter_pair(a, b, policy, filtered.points(), filtered.reach);
                if (verdict != Verdict::undecided) {
                    ASSERT_EQ(verdict == Verdict::collides, expected(pair, policy))
                        << pair << ", origin " << origin.x << ' ' << origin.y << ' ' << origin.z << ", policy "
                        << policy.skip_adjacent << policy.proper;
                } else if (!policy.proper && big == everything) {
                    ++undecided;
                }
            }
        }
    }
    EXPECT_LE(undecided, GetParam().undecided * 4 * rounds * 7 / 8);
}

INSTANTIATE_TEST_SUITE_P(All, Filters,
                         testing::Values(Case{Kind::random, false, 0.12}, Case{Kind::random_float, true, 0.12},
                                         Case{Kind::lattice, true, 0.3}, Case{Kind::lattice, false, 0.3},
                                         Case{Kind::flat, false, 0.45}, Case{Kind::nudged, false, 0.25},
                                         Case{Kind::wide, true, 0.45}, Case{Kind::wide, false, 0.25},
                                         Case{Kind::collapsed_lattice, true, 0.6}, Case{Kind::collapsed, false, 0.55},
                                         Case{Kind::threaded, true, 0.65}));

/// Triangles in general position that share nothing, or one corner: float32 decides nearly all of them.
TEST(FiltersInGeneralPosition, decide_nearly_all_pairs) {
    RandomPairs random(Kind::random_float, 59);
    int undecided = 0;
    constexpr int rounds = 20'000;
    for (int i = 0; i < rounds; ++i) {
        TrianglePair pair{{{random.point(), random.point(), random.point()}, {0, 1, 2}},
                          {{random.point(), random.point(), random.point()}, {3, 4, 5}}};
        if (i % 2) pair.b.point[0] = pair.a.point[1], pair.b.vertex[0] = 1;
        const FilteredPair filtered(pair, {}, 2, true);
        undecided += filter_pair(filtered.a, filtered.b, {}, filtered.points(), filtered.reach) == Verdict::undecided;
    }
    EXPECT_LE(undecided, rounds / 500);
}

// A corner a few units in the last place above, on or below the other triangle's plane: the sign is certain only beyond
// the error bound.
TEST(FiltersAtTheirEdge, sides_of_planes_are_undecided_within_the_error_bound) {
    for (int ulps = -64; ulps <= 64; ++ulps) {
        const double height = ulps * 0x1p-24;
        const Triangle floor{{Vec3d{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {0, 1, 2}};
        const Triangle above{{Vec3d{0, 0, height}, {0.5, 0, 1}, {0, 0.5, 1}}, {3, 4, 5}};
        const FilteredPair filtered({floor, above}, {}, 2, true);
        const PairSigns signs = pair_signs(filtered.a, filtered.b);
        EXPECT_EQ(signs.above_a & 1, ulps > 28 ? 1u : 0u) << ulps;
        EXPECT_EQ(signs.below_a & 1, ulps < -28 ? 1u : 0u) << ulps;
    }
}

/// Checks the turn signs of points r next to the line through p and q.
template <class T>
void expect_true_turns(double scale) {
    RandomPairs random(Kind::random, 67);
    int certain = 0;
    constexpr int rounds = 20'000;
    const auto number = [](double x) { return std::is_same_v<T, float> ? rounded(x) : static_cast<T>(x); };
    const auto at = [&] { return number(scale * random.real(-1, 1)); };
    for (int i = 0; i < rounds; ++i) {
        const T pu = at(), pw = at(), qu = at(), qw = at(), along = number(random.real(-1, 2));
        T ru = pu + along * (qu - pu), rw = pw + along * (qw - pw);
        for (int k = i % 16; k > 0; --k) rw = std::nextafter(rw, static_cast<T>(2 * scale));
        const int found = turn_sign<T>(qu - pu, qw - pw, ru - pu, rw - pw, {0, static_cast<T>(1e-36)});
        certain += found != 0;
        if (found == 0) continue;
        ASSERT_EQ(found, orient2d({pu, pw, 0}, {qu, qw, 0}, {ru, rw, 0}, 2)) << pu << ' ' << pw;
    }
    EXPECT_GT(certain, rounds / 4);
}

TEST(FiltersAtTheirEdge, turn_signs_are_right_or_undecided_next_to_lines) {
    for (const double scale : {1.0, 0x1p-20}) {
        expect_true_turns<float>(scale);
        expect_true_turns<double>(scale);
    }
}

TEST(FiltersAtTheirEdge, float64_sides_of_planes_are_right_or_undecided) {
    RandomPairs random(Kind::flat, 71);
    int certain = 0;
    constexpr int rounds = 20'000;
    for (int i = 0; i < rounds; ++i) {
        const auto [t, other] = random();
        Vec3d p = other.point[0];
        for (int k = i % 16; k > 0; --k) p.z = std::nextafter(p.z, 2.0);
        const Vec3d points[3] = {p, p, p};
        Vec3d normal;
        if (!plane_separates(t.point.data(), points, 0, 1e-290, normal)) continue;
        ++certain;
        const int found = dot(normal, p - t.point[0]) > 0 ? 1 : -1;
        ASSERT_EQ(found, orient3d(t.point[0], t.point[1], t.point[2], p)) << t;
    }
    EXPECT_GT(certain, rounds / 16);
}

TEST(EdgeOrder, puts_corners_alone_on_their_side_first_and_orients_the_others) {
    for (int below_a = 1; below_a < 7; ++below_a) {
        for (int below_b = 1; below_b < 7; ++below_b) {
            const int order = edge_order(below_a, below_b);
            const auto corner = [&](int place) { return order >> 2 * place & 3; };
            const auto lone = [](int below, int c) {
                return (below >> c & 1) != (below >> (c + 1) % 3 & 1) && (below >> c & 1) != (below >> (c + 2) % 3 & 1);
            };
            EXPECT_TRUE(lone(below_b, corner(0)));
            EXPECT_TRUE(lone(below_a, corner(3)));
            EXPECT_EQ((corner(1) - corner(0) + 3) % 3, below_a >> corner(3) & 1 ? 2 : 1);
            EXPECT_EQ((corner(4) - corner(3) + 3) % 3, below_b >> corner(0) & 1 ? 2 : 1);
            EXPECT_EQ(corner(0) + corner(1) + corner(2), 3);
            EXPECT_EQ(corner(3) + corner(4) + corner(5), 3);
        }
    }
}

TEST(Ball, encloses_its_triangle) {
    RandomPairs random(Kind::random_float, 61);
    for (int i = 0; i < 10'000; ++i) {
        const Vec3d p[3] = {random.point(), random.point(), random.point()};
        const Ball ball = ball_of(to_float(p[0]), to_float(p[1]), to_float(p[2]));
        for (const Vec3d& corner : p) {
            const Vec3d d = corner - Vec3d{ball.x, ball.y, ball.z};
            EXPECT_LE(std::sqrt(dot(d, d)), ball.r);
        }
    }
}

}  // namespace
}  // namespace crumple
