#include "exact/intersection/decide_intersection.h"

#include <gtest/gtest.h>

#include "base/float_environment.h"
#include "exact/intersection/exact_intersection.h"
#include "exact/intersection/intersection_decision.h"
#include "geometry/callers_mode.h"
#include "intersections/named_pairs.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace crumple {
namespace {

constexpr std::array neighbour_policies{Neighbours::geometric, Neighbours::skip};
constexpr std::array intersection_policies{IntersectionKind::all, IntersectionKind::proper};

/// Expects the rational decision under all policies, from both sides and with the corners in another order.
void expect_rational_decision(const TrianglePair& pair, int turn) {
    const RationalIntersection truth = intersect_rationally(pair.a, pair.b);
    const auto turned = [](const Triangle& t, int by, bool mirror) {
        Triangle result;
        for (int i = 0; i < 3; ++i) {
            const auto from = static_cast<std::size_t>((mirror ? 2 - i : i) + by) % 3;
            result.point[static_cast<std::size_t>(i)] = t.point[from];
            result.vertex[static_cast<std::size_t>(i)] = t.vertex[from];
        }
        return result;
    };
    const Triangle a = turned(pair.a, turn % 3, turn & 4), b = turned(pair.b, turn / 8 % 3, turn & 32);
    for (const Neighbours neighbours : neighbour_policies) {
        for (const IntersectionKind intersections : intersection_policies) {
            const bool expected = collide(truth, neighbours, intersections);
            DecisionCounts counts;
            ASSERT_EQ(collide(pair.a, pair.b, neighbours, intersections, counts), expected) << pair;
            ASSERT_EQ(collide(b, a, neighbours, intersections, counts), expected) << TrianglePair{b, a};
            ASSERT_LE(counts.exact, 2);
            ASSERT_LE(counts.rational, counts.exact);
        }
    }
}

class DecisionOfEachKind : public testing::TestWithParam<Kind> {
   protected:
    RandomPairs random{GetParam(), 29};
    int rounds() const { return rounds_of(GetParam(), 15'000); }
};

TEST_P(DecisionOfEachKind, agrees_with_rational_arithmetic) {
    for (int i = 0; i < rounds(); ++i) {
        const TrianglePair pair = random();
        const CallersMode caller(i);
        const FloatEnvironment ours;
        ASSERT_NO_FATAL_FAILURE(expect_rational_decision(pair, i));
    }
}

/// True for kinds with numbers that expansions cannot hold.
bool is_far(Kind kind) { return kind == Kind::huge || kind == Kind::tiny || kind == Kind::mixed; }

TEST_P(DecisionOfEachKind, needs_no_rationals_within_the_range_of_expansions) {
    if (is_far(GetParam())) GTEST_SKIP();
    for (int i = 0; i < rounds(); ++i) {
        const TrianglePair pair = random();
        DecisionCounts counts;
        collide(pair.a, pair.b, Neighbours::geometric, IntersectionKind::all, counts);
        collide(pair.a, pair.b, Neighbours::geometric, IntersectionKind::proper, counts);
        ASSERT_EQ(counts.rational, 0) << pair;
    }
}

TEST_P(DecisionOfEachKind, filters_alone_are_right_or_undecided) {
    int undecided = 0;
    for (int i = 0; i < rounds(); ++i) {
        const TrianglePair pair = random();
        for (const IntersectionKind intersections : intersection_policies) {
            FilteredSigns signs;
            const Verdict verdict = decide(pair.a, pair.b, Neighbours::geometric, intersections, signs);
            DecisionCounts counts;
            const bool expected = collide(pair.a, pair.b, Neighbours::geometric, intersections, counts);
            if (verdict == Verdict::undecided) {
                ++undecided;
            } else {
                ASSERT_EQ(verdict == Verdict::collides, expected) << pair;
            }
        }
    }
    if (GetParam() == Kind::random || GetParam() == Kind::random_float) {
        EXPECT_LT(undecided, rounds() / 3) << "of " << 2 * rounds();  // about the share of pairs with ties
    }
}

INSTANTIATE_TEST_SUITE_P(All, DecisionOfEachKind, testing::ValuesIn(all_kinds));

TEST(Decision, handmade_pairs_are_decided_as_expected) {
    for (const NamedPair& named : named_pairs()) {
        SCOPED_TRACE(named.claim);
        DecisionCounts counts;
        const auto& [a, b] = named.pair;
        EXPECT_EQ(collide(a, b, Neighbours::geometric, IntersectionKind::all, counts), named.collides);
        EXPECT_EQ(collide(a, b, Neighbours::geometric, IntersectionKind::proper, counts), named.proper);
        for (int turn = 0; turn < 64; ++turn) expect_rational_decision(named.pair, turn);
    }
}

// Tries every pattern of vertex ids: each corner of b is a corner of a or its own, and a may repeat a corner.
TEST(Decision, agrees_with_rationals_for_every_pattern_of_shared_vertices) {
    for (const Kind kind : {Kind::lattice, Kind::flat, Kind::random_float}) {
        RandomPairs random(kind, 31);
        for (int round = 0; round < 20; ++round) {
            for (int pattern = 0; pattern < 256; ++pattern) {
                TrianglePair pair{{{random.point(), random.point(), random.point()}, {0, 1, 2}},
                                  {{random.point(), random.point(), random.point()}, {3, 4, 5}}};
                if (pattern / 64 < 3) {
                    const auto from = static_cast<std::size_t>(pattern / 64), to = (from + 1) % 3;
                    pair.a.point[to] = pair.a.point[from];
                    pair.a.vertex[to] = pair.a.vertex[from];
                }
                for (std::size_t i = 0; i < 3; ++i) {
                    const auto choice = static_cast<std::size_t>(pattern >> (2 * i) & 3);
                    if (choice == 3) continue;
                    pair.b.point[i] = pair.a.point[choice];
                    pair.b.vertex[i] = pair.a.vertex[choice];
                }
                ASSERT_NO_FATAL_FAILURE(expect_rational_decision(pair, round + pattern));
            }
        }
    }
}

/// Returns a flat, tilted cloth of right-angled triangles. Adjacent ones lie in one plane, exactly or up to rounding.
std::vector<Triangle> flat_cloth(double slope_x, double slope_y) {
    constexpr int n = 8;
    const auto corner = [&](int i, int j) {
        return Vec3d{static_cast<double>(i), static_cast<double>(j), static_cast<float>(slope_x * i + slope_y * j)};
    };
    const auto id = [](int i, int j) { return i * (n + 1) + j; };
    std::vector<Triangle> cloth;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            cloth.push_back(
                {{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)}, {id(i, j), id(i + 1, j), id(i + 1, j + 1)}});
            cloth.push_back(
                {{corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)}, {id(i, j), id(i + 1, j + 1), id(i, j + 1)}});
        }
    }
    return cloth;
}

TEST(Decision, triangles_of_a_flat_cloth_need_no_exact_arithmetic) {
    for (const auto& cloth : {flat_cloth(0, 0), flat_cloth(0.37, 0.21), flat_cloth(1, 2)}) {
        for (std::size_t i = 0; i < cloth.size(); ++i) {
            for (std::size_t j = i + 1; j < cloth.size(); ++j) {
                DecisionCounts counts;
                EXPECT_FALSE(collide(cloth[i], cloth[j], Neighbours::geometric, IntersectionKind::all, counts));
                EXPECT_EQ(counts.exact, 0) << TrianglePair{cloth[i], cloth[j]};
            }
        }
    }
}

TEST(Decision, counts_exact_and_rational_decisions) {
    const auto counts_of = [](const TrianglePair& pair) {
        DecisionCounts counts;
        collide(pair.a, pair.b, Neighbours::geometric, IntersectionKind::all, counts);
        return std::array{counts.exact, counts.rational};
    };
    const Triangle floor{{Vec3d{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {0, 1, 2}};
    const Triangle across{{Vec3d{1, 1, -1}, {1, 1, 1}, {9, 8, 1}}, {3, 4, 5}};
    const Triangle touching{{Vec3d{1, 1, 0}, {1, 1, 2}, {2, 1, 2}}, {3, 4, 5}};
    const Triangle needle{{Vec3d{1, 1, 0}, {1, 1, 2}, {1, 1, 3}}, {3, 4, 5}};
    EXPECT_EQ(counts_of({floor, across}), (std::array<std::int64_t, 2>{0, 0}));
    EXPECT_EQ(counts_of({floor, touching}), (std::array<std::int64_t, 2>{1, 0}));
    EXPECT_EQ(counts_of({floor, needle}), (std::array<std::int64_t, 2>{1, 0}));
    const Triangle far{{Vec3d{1, 1, 0}, {1, 1, 2}, {2, 1, 0x1p400}}, {3, 4, 5}};
    EXPECT_EQ(counts_of({floor, far}), (std::array<std::int64_t, 2>{1, 1}));
}

#if defined(__SSE2__)
TEST(Decision, float_environment_keeps_decisions_right_and_restores_the_callers_mode) {
    const unsigned saved = _mm_getcsr();
    RandomPairs random(Kind::tiny, 37);
    for (int i = 0; i < 400; ++i) {
        const TrianglePair pair = random();
        for (const unsigned mode : {0x8040u, 0x2000u, 0x4000u, 0x6000u, 0xe040u}) {
            _mm_setcsr(saved | mode);
            {
                const FloatEnvironment guard;
                expect_rational_decision(pair, i);
            }
            const unsigned after_call = _mm_getcsr();
            _mm_setcsr(saved);
            ASSERT_EQ(after_call & 0xe040u, mode) << "the caller's mode is restored";
            ASSERT_FALSE(testing::Test::HasFatalFailure());
        }
    }
}
#endif

}  // namespace
}  // namespace crumple
