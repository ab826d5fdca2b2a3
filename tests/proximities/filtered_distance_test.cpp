// Checks that floating-point decisions about distances agree with rational arithmetic, and that floating-point
// arithmetic nearly always decides.

#include "exact/proximity/filtered_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "exact/proximity/decide_distance.h"
#include "geometry/exact.h"
#include "proximities/random_features.h"

namespace crumple {
namespace {

/// Counts of all attempts, and of attempts that left the result undecided.
struct Share {
    int attempts = 0, undecided = 0;
    void count(bool is_decided) { ++attempts, undecided += !is_decided; }
    double value() const { return static_cast<double>(undecided) / attempts; }
};

struct Shares {
    Share within, squared, down, closest;
};

/// Returns the squared distances that the kernels of a table compute in SIMD lanes, for a batch of equal features.
std::array<double, cpu::GuessBatch::most> squared_in_lanes(const cpu::FeatureTables& table, const Features& features) {
    cpu::GuessBatch batch;
    const detail::Guess guess = detail::guess_closest(detail::Differences(features));
    while (batch.count < cpu::GuessBatch::most) batch.add(features, guess);
    std::array<double, cpu::GuessBatch::most> squared;
    table.squared(batch, squared.data());
    return squared;
}

Rational exact_square(const RationalDistance& distance) {
    using boost::multiprecision::cpp_int;
    const auto integer = [](const Integer& x) { return cpp_int(x.str()); };
    const Rational quotient(integer(distance.quotient().numerator), integer(distance.quotient().denominator));
    const int power = 2 * distance.exponent();
    const Rational unit = Rational(cpp_int(1) << std::abs(power));
    return power < 0 ? Rational(quotient / unit) : Rational(quotient * unit);
}

void expect_no_contradiction(Proximity proximity, const RationalDistance& exact, const DistanceLimit& reach,
                             const Features& features) {
    if (proximity == Proximity::unknown) return;
    ASSERT_EQ(proximity == Proximity::within, exact.within(reach))
        << features << " at " << reach.a << " + " << reach.b << (reach.strict ? ", strict" : "");
}

/// Calls `check` for radii equal to the distance, for radii that differ from it by a few units in the last place or
/// less, and for radii that differ by more.
template <class Check>
void for_reaches(double distance, Check check) {
    for (const bool strict : {false, true}) {
        for (const int steps : {-40, -10, -3, -1, 0, 1, 2, 4, 10, 40}) {
            const double a = distance + steps * distance * 0x1p-52;
            check(DistanceLimit{a, 0, strict});
            check(DistanceLimit{a, a * 0x1p-60, strict});
            check(DistanceLimit{0.25 * a, 0.75 * a, strict});
        }
        for (const double factor : {0.0, 0.5, 0.999999, 1.000001, 2.0})
            check(DistanceLimit{factor * distance, 0, strict});
    }
}

void expect_exact_results(const Features& features, Shares& shares) {
    const RationalDistance exact(features);
    const double down = exact.rounded_down();
    const FilteredDistance quick(features);
    const detail::Differences differences(features);
    const detail::Guess guess = detail::guess_closest(differences);
    const Vec3d g = differences.w + guess.s * differences.u + guess.t * differences.v;
    detail::Enclosure enclosure = quick.enclosure();
    for_reaches(down, [&](const DistanceLimit& reach) {
        const double radius = reach.a + reach.b;
        // Checks each filter on its own, since compare() may hide the error of one of them.
        if (differences.within(g, radius)) {
            ASSERT_TRUE(exact.within(reach)) << features << " at " << radius;
        }
        if (differences.beyond(g, radius) || surely_out_of_reach(features, reach)) {
            ASSERT_FALSE(exact.within(reach)) << features << " at " << radius;
        }
        const Proximity proximity = quick.compare(reach);
        expect_no_contradiction(proximity, exact, reach, features);
        expect_no_contradiction(enclosure.compare(reach), exact, reach, features);
        shares.within.count(proximity != Proximity::unknown);
    });

    double rounded;
    const bool squared = enclosure.squared_rounded(rounded);
    shares.squared.count(squared);
    if (squared) {
        ASSERT_EQ(rounded, exact.squared()) << features;
    }
    const bool is_down_decided = enclosure.rounded_down(rounded);
    shares.down.count(is_down_decided);
    if (is_down_decided) {
        ASSERT_EQ(rounded, down) << features;
    }
    ClosestPoints points;
    const bool closest = enclosure.closest(points);
    shares.closest.count(closest);
    if (closest) {
        ASSERT_EQ(points, exact.closest()) << features;
    }
    ASSERT_TRUE(!enclosure.touching() || exact.touching()) << features;
    ASSERT_TRUE(!enclosure.apart() || !exact.touching()) << features;

    for (const auto* table : cpu::all_feature_kernels()) {
        const auto in_lanes = squared_in_lanes(*table, features);
        for (const double each : in_lanes)
            ASSERT_TRUE(each == in_lanes[0] || (std::isnan(each) && std::isnan(in_lanes[0]))) << features;
        if (std::isnan(in_lanes[0])) continue;
        ASSERT_EQ(in_lanes[0], exact.squared()) << features;
        ASSERT_FALSE(exact.touching()) << features;
    }

    if (enclosure.above() < std::numeric_limits<double>::infinity()) {
        const Rational square = exact_square(exact), f = value(enclosure.squared());
        ASSERT_LE(square, f + Rational(enclosure.above())) << features;
        if (enclosure.below() < std::numeric_limits<double>::infinity()) {
            ASSERT_GE(square, f - Rational(enclosure.below())) << features;
        }
    }

    DistanceCounts counts;
    Distance decided(features, counts);
    ASSERT_EQ(decided.squared(), exact.squared()) << features;
    ASSERT_EQ(decided.rounded_down(), down) << features;
    ASSERT_EQ(decided.touching(), exact.touching()) << features;
    ASSERT_EQ(decided.closest(), exact.closest()) << features;
    ASSERT_TRUE(decided.within({down, std::max(down * 0x1p-40, 0x1p-1074), true})) << features;
    ASSERT_EQ(decided.within({down, 0, false}), exact.within({down, 0, false})) << features;
    ASSERT_TRUE(squared || counts.rational == 1) << features;
    ASSERT_LE(counts.rational, 1) << features;
}

/// Change of lattice points that makes decisions about them hard.
struct Disturbance {
    std::string name;
    std::function<Vec3d(Vec3d, RandomFeatures&)> change;
    double most_undecided;  ///< highest share of each result that may be left to rationals
    friend std::ostream& operator<<(std::ostream& out, const Disturbance& disturbance) {
        return out << disturbance.name;
    }
};

Vec3d each(Vec3d p, const std::function<double(double)>& change) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = change(p[axis]);
    return p;
}

const Disturbance disturbances[] = {
    {"AsTheyAre", [](Vec3d p, auto&) { return p; }, 0.15},
    {"MovedByUnitsInTheLastPlace",
     [](Vec3d p, RandomFeatures& random) {
         return each(p, [&](double x) { return x + (random.below(5) - 2) * 0x1p-52; });
     },
     0.2},
    {"MovedByFloats",
     [](Vec3d p, RandomFeatures& random) {
         return each(
             p, [&](double x) { return static_cast<double>(static_cast<float>(x * 0.1 + random.below(100) * 1e-6)); });
     },
     0.05},
    {"MovedALittle",
     [](Vec3d p, RandomFeatures& random) {
         return each(p, [&](double x) { return x + 1e-9 * std::sin(random.below(1 << 30)); });
     },
     0.1},
    {"Anywhere",
     [](Vec3d p, RandomFeatures& random) {
         return each(p, [&](double x) { return x + std::sin(random.below(1 << 30)); });
     },
     0.01},
    {"FarFromTheOrigin",
     [](Vec3d p, RandomFeatures& random) {
         return each(p, [&](double x) { return 1e6 / 3 + 0.1 * x + 1e-3 * std::sin(random.below(1 << 30)); });
     },
     0.01},
    {"Slivers",
     [](Vec3d p, RandomFeatures& random) {
         return Vec3d{p.x + std::sin(random.below(1 << 30)), 1e-7 * (p.y + std::sin(random.below(1 << 30))),
                      p.z * 1e-3};
     },
     0.05},
    {"Tiny", [](Vec3d p, auto&) { return 0x1p-1060 * p; }, 1},
    {"Huge", [](Vec3d p, auto&) { return 0x1p1000 * p; }, 1},
    {"Around1e150", [](Vec3d p, auto&) { return 1e150 * p; }, 1},
    {"Around1e-150", [](Vec3d p, auto&) { return 1e-150 * p; }, 1},
    {"TooLargeForPairs", [](Vec3d p, auto&) { return 0x1p270 * p; }, 1},
    {"AtTheBorderOfLargeNumbers", [](Vec3d p, auto&) { return 0x1.3p236 * p; }, 0.7},
    {"AtTheBorderOfSmallNumbers", [](Vec3d p, auto&) { return 0x1.3p-200 * p; }, 0.2},
    {"OfMixedMagnitudes",
     [](Vec3d p, RandomFeatures& random) {
         return each(p, [&](double x) { return std::ldexp(x, random.below(600) - 300); });
     },
     0.9},
};

class FilteredResults : public testing::TestWithParam<Disturbance> {};

TEST_P(FilteredResults, equal_exact_results_where_decided) {
    Shares shares;
    for_features(23, 60, [&](Features features, RandomFeatures& random) {
        for (Vec3d& p : features.point) p = GetParam().change(p, random);
        expect_exact_results(features, shares);
    });
    EXPECT_LE(shares.within.value(), GetParam().most_undecided);
    EXPECT_LE(shares.squared.value(), GetParam().most_undecided);
    EXPECT_LE(shares.down.value(), GetParam().most_undecided);
    EXPECT_LE(shares.closest.value(), GetParam().most_undecided);
}

INSTANTIATE_TEST_SUITE_P(Disturbances, FilteredResults, testing::ValuesIn(disturbances), [](const auto& info) {
    std::string name = info.param.name;
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
});

// Each table of kernels either computes nothing (scalar code) or decides nearly all features in general position.
TEST(FilteredDistance, each_simd_kernel_decides_nearly_all_features_in_general_position_or_none) {
    const auto tables = cpu::all_feature_kernels();
    std::vector<Share> shares(tables.size());
    for_features(31, 60, [&](Features features, RandomFeatures& random) {
        features = with_points(
            features, [&](Vec3d p) { return each(p, [&](double x) { return x + std::sin(random.below(1 << 30)); }); });
        for (std::size_t i = 0; i < tables.size(); ++i)
            shares[i].count(!std::isnan(squared_in_lanes(*tables[i], features)[0]));
    });
    for (const Share& share : shares)
        EXPECT_TRUE(share.undecided == share.attempts || share.value() < 0.02) << share.value();
    EXPECT_EQ(shares.front().undecided, shares.front().attempts);  // the scalar table decides nothing
}

// A batch can hold any number of features of all kinds.
TEST(FilteredDistance, simd_results_do_not_depend_on_the_batch) {
    for (const auto* table : cpu::all_feature_kernels())
        for (std::size_t count = 0; count <= cpu::GuessBatch::most; ++count) {
            RandomFeatures random(Points::wide, 37);
            cpu::GuessBatch batch;
            std::vector<double> expected;
            while (batch.count < count) {
                const Features features = random(all_kinds[batch.count % 4]);
                batch.add(features, detail::guess_closest(detail::Differences(features)));
                expected.push_back(squared_in_lanes(*table, features)[0]);
            }
            double squared[cpu::GuessBatch::most];
            table->squared(batch, squared);
            for (std::size_t i = 0; i < count; ++i)
                ASSERT_TRUE(squared[i] == expected[i] || (std::isnan(squared[i]) && std::isnan(expected[i])));
        }
}

// On a lattice nothing is rounded, so ties (radii equal to the distance) need no rational arithmetic.
TEST(FilteredDistance, ties_on_lattices_need_no_rationals) {
    const Vec3d o{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0};
    const struct {
        Features features;
        double distance;
    } ties[] = {
        {vertex_vertex({1, 2, 3}, {4, 6, 3}), 5},
        {vertex_edge({2, 3, 0}, o, x), 3},             // above the interior of the edge
        {vertex_edge({0, 3, 4}, o, x), 5},             // above an end
        {vertex_face({1, 2, 3}, o, x, y), 3},          // above the interior of the face
        {vertex_face({1, 0, 3}, o, x, y), 3},          // above each edge
        {vertex_face({0, 1, 3}, o, x, y), 3},          //
        {vertex_face({2, 2, 3}, o, x, y), 3},          //
        {vertex_face({0, 0, 3}, o, x, y), 3},          // above each corner
        {vertex_face({4, 0, 3}, o, x, y), 3},          //
        {vertex_face({0, 4, 3}, o, x, y), 3},          //
        {edge_edge(o, x, {1, -1, 3}, {1, 3, 3}), 3},   // interior above interior
        {edge_edge(o, x, {1, 0, 3}, {1, 4, 3}), 3},    // an end above the interior
        {edge_edge(o, x, {0, 0, 3}, {0, 4, 3}), 3},    // ends above each other
        {edge_edge(o, x, {0, 3, 0}, {4, 3, 0}), 3},    // parallel
        {edge_edge(o, x, {4, 3, 0}, {0, 3, 0}), 3},    //
        {edge_edge(o, x, {1, 3, 0}, {3, 3, 0}), 3},    //
        {edge_edge(o, x, {7, 0, 0}, {9, 0, 0}), 3},    // on one line
        {edge_edge(o, x, {1, 3, 0}, {1, 3, 0}), 3},    // collapsed
        {edge_edge({1, 3, 0}, {1, 3, 0}, o, x), 3},    //
        {vertex_face({1, 3, 0}, o, x, {2, 0, 0}), 3},  //
        {vertex_face({1, 1, 0}, o, x, y), 0},          // touching
        {edge_edge(o, x, {1, -1, 0}, {1, 3, 0}), 0},   //
        {edge_edge(o, x, {1, 0, 0}, {1, 3, 0}), 0},    //
        {edge_edge(o, x, {4, 0, 0}, {1, 3, 0}), 0},    //
    };
    for (const auto& [features, distance] : ties) {
        for (const double unit : {1.0, 0x1p-20, 0x1p50}) {
            const Features scaled = with_points(features, [&](Vec3d p) { return unit * p; });
            const double d = unit * distance;
            DistanceCounts counts;
            Distance decided(scaled, counts);
            EXPECT_TRUE(decided.within({d, 0, false})) << scaled;
            EXPECT_TRUE(decided.within({0.5 * d, 0.5 * d, false})) << scaled;
            EXPECT_FALSE(decided.within({d, 0, true})) << scaled;
            EXPECT_TRUE(decided.within({d, unit * 0x1p-60, true})) << scaled;
            EXPECT_EQ(decided.squared(), d * d) << scaled;
            EXPECT_EQ(decided.rounded_down(), d) << scaled;
            EXPECT_EQ(decided.touching(), d == 0) << scaled;
            EXPECT_EQ(counts.rational, 0) << scaled;
            EXPECT_EQ(decided.closest(), RationalDistance(scaled).closest()) << scaled;
        }
    }
}

// Checks that correct bounds are not too wide: they are at most 2^-70 of the squared distance, and at least one error
// reaches a fiftieth of its bound.
TEST(FilteredDistance, error_bounds_are_at_most_2_to_the_minus_70_of_the_squared_distance) {
    double closest_to_bound = 0;
    for_features(29, 60, [&](Features features, RandomFeatures& random) {
        features = with_points(
            features, [&](Vec3d p) { return each(p, [&](double x) { return x + std::sin(random.below(1 << 30)); }); });
        const detail::Enclosure enclosure = FilteredDistance(features).enclosure();
        const Rational square = exact_square(RationalDistance(features)), f = value(enclosure.squared());
        ASSERT_LE(Rational(enclosure.below() + enclosure.above()), square * Rational(0x1p-70)) << features;
        const Rational part = square < f ? Rational((f - square) / Rational(enclosure.below()))
                                         : Rational((square - f) / Rational(enclosure.above()));
        closest_to_bound = std::max(closest_to_bound, static_cast<double>(part));
    });
    EXPECT_LE(closest_to_bound, 1);
    EXPECT_GE(closest_to_bound, 0.02);
}

}  // namespace
}  // namespace crumple
