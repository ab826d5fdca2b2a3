// Properties that relate results of similar queries about motion and proximity.

#include <gtest/gtest.h>

#include <numeric>

#include "features/compare_features.h"
#include "features/moving_soups.h"

namespace crumple::test {
namespace {

/// A row of a result by vertices and triangles: a vertex and a triangle, or the ends of both edges.
struct Hit {
    bool edges;
    std::array<std::int32_t, 4> id;
    double value;
    bool flag;
    friend auto operator<=>(const Hit&, const Hit&) = default;
    friend std::ostream& operator<<(std::ostream& out, const Hit& hit) {
        out << (hit.edges ? "edges" : "vertex and face");
        for (const std::int32_t id : hit.id) out << ' ' << id;
        return out << ", value " << hit.value << ", flag " << hit.flag;
    }
};
using Hits = std::vector<Hit>;

template <class Result>
Hits hits_of(const Result& result) {
    Hits hits;
    for (const bool edges : {false, true}) {
        const auto& list = edges ? result.edge_edges() : result.vertex_faces();
        for (std::size_t i = 0; i < list.pairs.size(); ++i) {
            const Pair pair = list.pairs[i];
            Hit hit{edges, {pair.a, pair.b, 0, 0}, values_of(list)[i], flags_of(list)[i] != 0};
            if (edges) {
                const Edge e = result.edges[pair.a], f = result.edges[pair.b];
                hit.id = {e.a, e.b, f.a, f.b};
            }
            hits.push_back(hit);
        }
    }
    std::sort(hits.begin(), hits.end());
    return hits;
}
template <class Change>
Hits with(Hits hits, Change change) {
    for (Hit& hit : hits) change(hit);
    std::sort(hits.begin(), hits.end());
    return hits;
}
Hits without_values(Hits hits) {
    return with(std::move(hits), [](Hit& hit) { hit.value = 0, hit.flag = false; });
}

void expect_same(const Hits& found, const Hits& expected) {
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) ASSERT_EQ(found[i], expected[i]) << i;
    ASSERT_EQ(found.size(), expected.size());
}
void expect_within(const Hits& part, const Hits& all) {
    EXPECT_TRUE(std::includes(all.begin(), all.end(), part.begin(), part.end()));
}

class FeatureProperties : public testing::TestWithParam<unsigned> {
   protected:
    Hits impacts(const MovingSoup<>& soup, const ImpactQuery& query = {}) {
        return hits_of(detector_.find(soup.view().moving_to(soup.end_view()), query));
    }
    Hits near(const MovingSoup<>& soup, const ProximityQuery& query) {
        return hits_of(detector_.find(soup.view(), query));
    }
    /// Returns small soups of some kinds, with many hits.
    std::vector<MovingSoup<>> soups() const {
        const unsigned seed = 100 + GetParam();
        return {moving_grid(3, 14, 12, seed), moving_grid(8, 30, 20, seed), moving_in_a_plane(14, 9, seed),
                in_general(30, 0.5, 0.4, seed), collapsing(8, seed)};
    }
    Draw draw_{GetParam()};
    std::vector<std::int32_t> any_order(std::size_t n) {
        std::vector<std::int32_t> order(n);
        std::iota(order.begin(), order.end(), 0);
        for (std::size_t i = n; i > 1; --i)
            std::swap(order[i - 1], order[static_cast<std::size_t>(draw_.below(static_cast<int>(i)))]);
        return order;
    }
    Detector detector_{Options{.backend = Backend::cpu, .threads = 2, .leaf_size = 8}};
};

TEST_P(FeatureProperties, order_of_vertices_triangles_and_corners_does_not_matter) {
    for (const MovingSoup<>& soup : soups()) {
        const auto vertex = any_order(soup.start.size()), triangle = any_order(soup.triangles.size());
        MovingSoup<> other = soup;
        for (std::size_t v = 0; v < vertex.size(); ++v) {
            const auto to = static_cast<std::size_t>(vertex[v]);
            other.start[to] = soup.start[v];
            other.end[to] = soup.end[v];
        }
        for (std::size_t t = 0; t < triangle.size(); ++t) {
            const auto turn = any_order(3);
            for (std::size_t k = 0; k < 3; ++k)
                other.triangles[static_cast<std::size_t>(triangle[t])][k] =
                    vertex[static_cast<std::size_t>(soup.triangles[t][static_cast<std::size_t>(turn[k])])];
        }
        const auto renamed = [&](Hit& hit) {
            auto& [a, b, c, d] = hit.id;
            const auto name = [&](std::int32_t& id, const auto& order) { id = order[static_cast<std::size_t>(id)]; };
            name(a, vertex);
            name(b, hit.edges ? vertex : triangle);
            if (!hit.edges) return;
            name(c, vertex);
            name(d, vertex);
            if (a > b) std::swap(a, b);
            if (c > d) std::swap(c, d);
            if (std::pair(a, b) > std::pair(c, d)) hit.id = {c, d, a, b};
        };
        expect_same(impacts(other), with(impacts(soup), renamed));
        expect_same(near(other, {.radius = 0.5}), with(near(soup, {.radius = 0.5}), renamed));
    }
}

TEST_P(FeatureProperties, swapping_or_mirroring_axes_does_not_matter) {
    for (const MovingSoup<>& soup : soups()) {
        const auto axis = any_order(3);
        const PointOf<double> sign{draw_.below(2) * 2. - 1, draw_.below(2) * 2. - 1, draw_.below(2) * 2. - 1};
        MovingSoup<> turned = soup;
        for (auto* points : {&turned.start, &turned.end})
            for (auto& p : *points) {
                const auto old = p;
                for (std::size_t k = 0; k < 3; ++k) p[k] = sign[k] * old[static_cast<std::size_t>(axis[k])];
            }
        expect_same(impacts(turned), impacts(soup));
        expect_same(near(turned, {.radius = 0.5}), near(soup, {.radius = 0.5}));
    }
}

TEST_P(FeatureProperties, scaling_by_powers_of_two_does_not_matter) {
    for (const MovingSoup<>& soup : soups())
        for (const int exponent : {-900, -400, -20, 30, 400, 1000}) {
            const double scale = std::ldexp(1, exponent);
            const MovingSoup<> scaled = changed<double>(soup, [&](double x) { return scale * x; });
            expect_same(impacts(scaled), impacts(soup));
            // Values are rounded once, so they scale unless they leave the range of numbers.
            const Hits expected =
                with(near(soup, {.radius = 0.5}), [&](Hit& hit) { hit.value = std::ldexp(hit.value, 2 * exponent); });
            if (std::abs(exponent) == 400 || std::abs(exponent) < 100)
                expect_same(near(scaled, {.radius = 0.5 * scale}), expected);
            else
                expect_same(without_values(near(scaled, {.radius = 0.5 * scale})), without_values(expected));
        }
}

TEST_P(FeatureProperties, exact_translations_and_common_motions_do_not_matter) {
    for (const MovingSoup<>& soup : soups()) {
        if (soup.start[0][0] != std::floor(soup.start[0][0])) continue;  // sums of integers are exact
        const PointOf<double> by{draw_.integer(-1000, 1000) * 0x1p40, draw_.integer(-1000, 1000) * 0x1p10,
                                 draw_.integer(-1000, 1000) * 0x1p30};
        MovingSoup<> moved = soup;
        for (auto* points : {&moved.start, &moved.end})
            for (auto& p : *points)
                for (std::size_t k = 0; k < 3; ++k) p[k] += by[k];
        expect_same(impacts(moved), impacts(soup));
        expect_same(near(moved, {.radius = 1}), near(soup, {.radius = 1}));
        // Adds a common motion.
        for (auto& p : moved.end)
            for (std::size_t k = 0; k < 3; ++k) p[k] -= 3 * by[(k + 1) % 3];
        expect_same(impacts(moved), impacts(soup));
    }
}

TEST_P(FeatureProperties, reversed_motion_has_impacts_of_the_same_features) {
    for (const MovingSoup<>& soup : soups()) {
        MovingSoup<> back = soup;
        std::swap(back.start, back.end);
        expect_same(without_values(impacts(back)), without_values(impacts(soup)));
    }
}

TEST_P(FeatureProperties, static_contacts_are_the_impacts_at_the_start) {
    for (MovingSoup<> soup : soups()) {
        const Hits from_start = impacts(soup);
        soup.end = soup.start;
        const Hits touching = near(soup, {});
        for (const Hit& hit : touching) EXPECT_TRUE(hit.flag && hit.value == 0) << hit;
        const Hits of_static = impacts(soup);
        for (const Hit& hit : of_static) EXPECT_TRUE(hit.flag && hit.value == 0) << hit;
        expect_same(of_static, touching);
        Hits start;
        for (const Hit& hit : from_start) {
            EXPECT_TRUE(!hit.flag || hit.value == 0);
            if (hit.flag) start.push_back(hit);
        }
        expect_same(start, touching);
        EXPECT_TRUE(near(soup, {.strict = true}).empty());
    }
}

TEST_P(FeatureProperties, smaller_radius_gives_the_nearer_pairs_of_a_larger_one) {
    for (const MovingSoup<>& soup : soups())
        for (const double radius : {0.25, 1.0}) {
            const Hits hits = near(soup, {.radius = radius}), more = near(soup, {.radius = 1.5 * radius});
            expect_within(hits, more);
            // All hits within the radius, and no others. Squared distances of such small numbers are exact enough for
            // this comparison.
            Hits expected;
            for (const Hit& hit : more)
                if (hit.value <= radius * radius) expected.push_back(hit);
            expect_same(hits, expected);
            const Hits strict = near(soup, {.radius = radius, .strict = true});
            expect_within(strict, hits);
            for (const Hit& hit : hits) EXPECT_TRUE(hit.value <= radius * radius);
        }
}

TEST_P(FeatureProperties, proximities_are_impacts_at_the_start_within_a_distance) {
    for (const MovingSoup<>& soup : soups()) {
        if (soup.triangles.size() > 15) continue;  // minimum distances take long
        const Hits apart = impacts(soup, {.min_distance = 0.5}), hits = impacts(soup);
        Hits start;
        for (const Hit& hit : apart)
            if (hit.flag) start.push_back(hit);
        expect_same(without_values(start), without_values(near(soup, {.radius = 0.5})));
        expect_within(without_values(hits), without_values(apart));
        expect_same(impacts(soup, {.min_distance = 0, .min_distance_share = 0}), hits);
    }
}

// Once an impact is found, later leaves are built for the motion up to its time.
TEST_P(FeatureProperties, first_impact_among_many_leaves_is_the_first_of_all_impacts) {
    int inside = 0, many = 0;  // numbers of first impacts with toi > 0, and of soups with many impacts
    const auto expect_first = [&](const auto& soup, const ImpactQuery& query) {
        const auto step = soup.view().moving_to(soup.end_view());
        const Impacts all = detector_.find(step, query);
        many += all.vertex_faces().pairs.size() + all.edge_edges().pairs.size() > 5;
        for (const int threads : {1, 2}) {
            const FirstImpact found =
                Detector({.threads = threads, .leaf_size = 10}).find(step, FirstImpactQuery{query});
            EXPECT_EQ(found, all.first);
            inside += found.toi > 0;
        }
    };
    for (int k = 0; k < scaled_rounds(6); ++k) {
        const unsigned seed = 1000 * GetParam() + static_cast<unsigned>(k);
        MovingSoup<> soup = in_general(150, 0.05, k % 2 ? 0.1 : 0.4, seed);
        if (k % 3 == 2) soup.append(moving_grid(9, 20, 20, seed));
        for (const ImpactQuery& query : {ImpactQuery{}, ImpactQuery{.min_distance_share = 0.3}}) {
            expect_first(soup, query);
            expect_first(rounded<float>(soup), query);
        }
    }
    EXPECT_GT(inside, 0);
    EXPECT_GT(many, 0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FeatureProperties, testing::Range(0u, 4u));

}  // namespace
}  // namespace crumple::test
