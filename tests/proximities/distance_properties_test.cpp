// Checks that some changes of features leave their distance as it is, that other changes have the expected effect, and
// that independent computations give the same distance.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "exact/intersection/exact_intersection.h"
#include "geometry/exact.h"
#include "proximities/random_features.h"

namespace crumple {
namespace {

constexpr int rounds = 150;

/// Results that do not depend on how points are numbered.
struct Results {
    double squared, rounded_down;
    bool touching;
    friend bool operator==(const Results&, const Results&) = default;
    friend std::ostream& operator<<(std::ostream& out, const Results& results) {
        return out << results.squared << ", " << results.rounded_down << (results.touching ? ", touching" : "");
    }
};

Results results_of(const Features& features) {
    const RationalDistance distance(features);
    return {distance.squared(), distance.rounded_down(), distance.touching()};
}

/// Returns the features with their points in other orders.
std::vector<Features> reordered(const Features& features) {
    const auto& [p, q, r, s] = features.point;
    switch (features.kinds) {
        case FeatureKinds::vertex_face:
            return {vertex_face(p, r, s, q), vertex_face(p, s, q, r), vertex_face(p, r, q, s)};
        case FeatureKinds::edge_edge:
            return {edge_edge(q, p, r, s), edge_edge(p, q, s, r), edge_edge(r, s, p, q), edge_edge(s, r, q, p)};
        case FeatureKinds::vertex_edge:
            return {vertex_edge(p, r, q), vertex_face(p, q, r, r), vertex_face(p, q, r, q), edge_edge(p, p, q, r)};
        case FeatureKinds::vertex_vertex:
            break;
    }
    return {vertex_vertex(q, p), vertex_edge(p, q, q), vertex_face(p, q, q, q), edge_edge(p, p, q, q)};
}

TEST(Distance, does_not_depend_on_the_order_of_points) {
    for_features(3, rounds, [](const Features& features, auto&) {
        for (const Features& other : reordered(features))
            ASSERT_EQ(results_of(other), results_of(features)) << features;
    });
}

TEST(Distance, does_not_depend_on_the_axes_or_the_origin) {
    for_features(5, rounds, [](const Features& features, auto&) {
        const auto changed = [&](auto change) {
            const RationalDistance one(features), other(with_points(features, change));
            return std::pair(results_of(with_points(features, change)) == results_of(features),
                             other.closest() == one.closest());
        };
        const std::pair same(true, true);
        ASSERT_EQ(changed([](Vec3d p) { return Vec3d{p.y, p.z, p.x}; }), same) << features;
        ASSERT_EQ(changed([](Vec3d p) { return Vec3d{p.y, p.x, -p.z}; }), same) << features;
        ASSERT_EQ(changed([](Vec3d p) { return p + Vec3d{0x1p46, -1e6, 0.25}; }), same) << features;
    });
}

TEST(Distance, scales_with_the_unit) {
    for_features(7, rounds, [](const Features& features, auto&) {
        const RationalDistance distance(features);
        for (const int power : {-1074, -1022, -540, -500, 500, 508, 1017}) {
            const RationalDistance other(with_points(features, [&](Vec3d p) { return std::ldexp(1, power) * p; }));
            ASSERT_EQ(other.touching(), distance.touching()) << features;
            ASSERT_EQ(other.closest(), distance.closest()) << features;
            if (power == 1017) {
                const double expected = std::ldexp(distance.rounded_down(), power);
                ASSERT_EQ(other.rounded_down(), std::min(expected, std::numeric_limits<double>::max())) << features;
            }
            if (std::abs(power) == 500) {
                ASSERT_EQ(other.squared(), std::ldexp(distance.squared(), 2 * power)) << features;
            }
            const DistanceLimit reach{std::ldexp(1, power), std::ldexp(3, power), true};
            ASSERT_EQ(other.within(reach), distance.within({1, 3, true})) << features;
        }
    });
}

// Search for comparison, over all pairs of parts: a part of a feature is the feature itself, or one of its edges or
// corners. Finds the closest points of the affine hulls of each pair of parts, by Lagrange multipliers and without
// cross products, and takes the closest of these that are in the features.

using Matrix = std::vector<std::vector<Rational>>;

/// Returns the solution of a system whose last column is the right-hand side, or nothing if it is not unique.
std::optional<std::vector<Rational>> solve(Matrix rows) {
    const std::size_t n = rows.size();
    for (std::size_t i = 0; i < n; ++i) {
        const auto pivot = std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(i), rows.end(),
                                        [&](const auto& row) { return row[i] != 0; });
        if (pivot == rows.end()) return std::nullopt;
        std::swap(*pivot, rows[i]);
        for (std::size_t j = 0; j < n; ++j) {
            if (j == i || rows[j][i] == 0) continue;
            const Rational factor = rows[j][i] / rows[i][i];
            for (std::size_t k = i; k <= n; ++k) rows[j][k] -= factor * rows[i][k];
        }
    }
    std::vector<Rational> solution(n);
    for (std::size_t i = 0; i < n; ++i) solution[i] = rows[i][n] / rows[i][i];
    return solution;
}

/// One pair of parts, with the barycentric weights of the closest points of their affine hulls.
struct Nearest {
    Rational squared;
    unsigned chosen = 0;           ///< corners of the parts: one bit for each point of both features
    std::vector<Rational> weight;  ///< barycentric weight of each point of both features
};

/// Minimises |Σ wᵢ σᵢ pᵢ|² over the chosen points, with σ = 1 for the first feature, σ = −1 for the second, and weights
/// that add up to 1 for each. `split`: number of points of the first feature. Returns nothing if the minimum is not
/// unique, or not in the parts.
std::optional<Nearest> nearest_of_hulls(const Features& features, std::size_t split, unsigned chosen) {
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < points_of(features.kinds); ++i) {
        if (chosen >> i & 1) index.push_back(i);
    }
    const std::size_t n = index.size();
    const auto product = [&](std::size_t i, std::size_t j) {
        Rational sum = 0;
        for (int axis = 0; axis < 3; ++axis)
            sum += Rational(features.point[i][axis]) * Rational(features.point[j][axis]);
        return (i < split) == (j < split) ? sum : Rational(-sum);
    };
    Matrix rows(n + 2, std::vector<Rational>(n + 3));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) rows[i][j] = product(index[i], index[j]);
        const std::size_t constraint = n + (index[i] < split ? 0 : 1);
        rows[i][constraint] = rows[constraint][i] = 1;
    }
    rows[n][n + 2] = rows[n + 1][n + 2] = 1;
    const auto solution = solve(rows);
    if (!solution) return std::nullopt;
    Nearest nearest{0, chosen, std::vector<Rational>(points_of(features.kinds))};
    for (std::size_t i = 0; i < n; ++i) {
        if ((*solution)[i] < 0) return std::nullopt;
        nearest.weight[index[i]] = (*solution)[i];
        for (std::size_t j = 0; j < n; ++j) {
            nearest.squared += (*solution)[i] * (*solution)[j] * rows[i][j];
        }
    }
    return nearest;
}

std::size_t split_of(const Features& features) { return features.kinds == FeatureKinds::edge_edge ? 2 : 1; }

/// Returns the corners of each pair of parts, one bit for each, in the order of ClosestPoints::type. The points of the
/// first feature are the lower bits.
std::vector<unsigned> parts(FeatureKinds kinds) {
    switch (kinds) {
        case FeatureKinds::vertex_face:
            return {0b0011, 0b0101, 0b1001, 0b0111, 0b1101, 0b1011, 0b1111};
        case FeatureKinds::edge_edge:
            return {0b0101, 0b1001, 0b0110, 0b1010, 0b0111, 0b1011, 0b1101, 0b1110, 0b1111};
        case FeatureKinds::vertex_edge:
            return {0b011, 0b101, 0b111};
        case FeatureKinds::vertex_vertex:
            break;
    }
    return {0b11};
}

/// Returns the closest pair of parts and its type; if several are equally close, the first.
std::pair<Nearest, std::uint8_t> search(const Features& features) {
    std::optional<Nearest> best;
    std::uint8_t type = 0, best_type = 0;
    for (const unsigned chosen : parts(features.kinds)) {
        auto nearest = nearest_of_hulls(features, split_of(features), chosen);
        if (nearest && (!best || nearest->squared < best->squared)) {
            best = std::move(nearest);
            best_type = type;
        }
        ++type;
    }
    return {*best, best_type};
}

Rational exactly(double x) { return Rational(x); }

TEST(Distance, matches_a_search_of_all_parts_of_the_features) {
    std::map<std::pair<FeatureKinds, int>, int> found;
    for_features(11, 60, [&](const Features& features, RandomFeatures& random) {
        const RationalDistance distance(features);
        const auto [nearest, type] = search(features);
        const ClosestPoints closest = distance.closest();
        ++found[{features.kinds, type}];
        ASSERT_EQ(closest.type, type) << features;
        ASSERT_EQ(distance.touching(), nearest.squared == 0) << features;
        ASSERT_EQ(distance.squared(), static_cast<double>(nearest.squared)) << features;
        // The square of `down` is at most the squared distance; the square of the next number is above it.
        const double down = distance.rounded_down();
        ASSERT_LE(exactly(down) * exactly(down), nearest.squared) << features;
        const Rational up = exactly(std::nextafter(down, 1e9));
        ASSERT_GT(up * up, nearest.squared) << features;

        const auto& weight = nearest.weight;
        std::array<Rational, 2> at{0, 0};
        if (features.kinds == FeatureKinds::vertex_face) at = {weight[2], weight[3]};
        if (features.kinds == FeatureKinds::edge_edge) at = {weight[1], weight[3]};
        if (features.kinds == FeatureKinds::vertex_edge) at = {weight[2], 0};
        ASSERT_EQ(closest.at[0], static_cast<double>(at[0])) << features;
        ASSERT_EQ(closest.at[1], static_cast<double>(at[1])) << features;

        for (int i = 0; i < 4; ++i) {
            const double a = 0.25 * random.below(20), b = 0.5 * random.below(10);
            const Rational sum = exactly(a) + exactly(b);
            ASSERT_EQ(distance.within({a, b, false}), nearest.squared <= sum * sum) << features;
            ASSERT_EQ(distance.within({a, b, true}), nearest.squared < sum * sum) << features;
        }
        // Radii next to the distance itself.
        const DistanceLimit reach{down, 0, false};
        ASSERT_EQ(distance.within(reach), exactly(down) * exactly(down) == nearest.squared) << features;
        ASSERT_TRUE(distance.within({down, std::max(down * 0x1p-52, 0x1p-1074), true})) << features;
    });
    EXPECT_EQ(found.size(), 7U + 9U + 3U + 1U) << "some type was never found";
}

TEST(Distance, is_zero_iff_the_features_intersect) {
    int touching = 0;
    for_features(13, rounds, [&](const Features& features, auto&) {
        const auto& [p, q, r, s] = features.point;
        const auto [a, b] =
            features.kinds == FeatureKinds::vertex_face   ? std::pair(std::array{p, p, p}, std::array{q, r, s})
            : features.kinds == FeatureKinds::edge_edge   ? std::pair(std::array{p, q, q}, std::array{r, s, s})
            : features.kinds == FeatureKinds::vertex_edge ? std::pair(std::array{p, p, p}, std::array{q, r, r})
                                                          : std::pair(std::array{p, p, p}, std::array{q, q, q});
        const bool expected = intersect_rationally({a, {0, 1, 2}}, {b, {3, 4, 5}}).collides;
        ASSERT_EQ(RationalDistance(features).touching(), expected) << features;
        touching += expected;
    });
    EXPECT_GT(touching, 100);
}

// Gives each coordinate a magnitude of its own, over nearly all of float64.
TEST(Distance, order_of_points_and_axes_does_not_matter_at_mixed_magnitudes) {
    for (const FeatureKinds kinds : all_kinds) {
        RandomFeatures random(Points::tiny, 17);
        for (int i = 0; i < 20; ++i) {
            const Features features = with_points(random(kinds), [&](Vec3d p) {
                for (int axis = 0; axis < 3; ++axis) p[axis] = std::ldexp(p[axis], random.below(2'000) - 1'000);
                return p;
            });
            for (const Features& other : reordered(features))
                ASSERT_EQ(results_of(other), results_of(features)) << features;
            const RationalDistance distance(features);
            const double down = distance.rounded_down();
            ASSERT_TRUE(distance.within({std::nextafter(down, INFINITY), 0, true})) << features;
            ASSERT_FALSE(distance.within({down, 0, true})) << features;
            ASSERT_EQ(results_of(with_points(features,
                                             [](Vec3d p) {
                                                 return Vec3d{p.z, -p.x, p.y};
                                             })),
                      results_of(features))
                << features;
        }
    }
}

// Replacing a feature by a part of it (a face by an edge, or an edge by an end) never decreases the distance.
TEST(Distance, is_at_most_the_distance_of_parts) {
    for_features(19, rounds, [](const Features& features, auto&) {
        const auto& [p, q, r, s] = features.point;
        std::vector<Features> smaller;
        if (features.kinds == FeatureKinds::vertex_face)
            smaller = {vertex_edge(p, q, r), vertex_edge(p, r, s), vertex_edge(p, s, q)};
        if (features.kinds == FeatureKinds::edge_edge)
            smaller = {vertex_edge(p, r, s), vertex_edge(q, r, s), vertex_edge(r, p, q), vertex_edge(s, p, q)};
        if (features.kinds == FeatureKinds::vertex_edge) smaller = {vertex_vertex(p, q), vertex_vertex(p, r)};
        for (const Features& part : smaller) {
            ASSERT_LE(results_of(features).squared, results_of(part).squared) << features;
            ASSERT_LE(results_of(features).rounded_down, results_of(part).rounded_down) << features;
        }
    });
}

}  // namespace
}  // namespace crumple
