// Tests of public parts (Detector::partition) for feature queries: each part can be searched without the mesh, and the
// results of all parts together have the rows of the whole result, byte by byte, without duplicates.

#include <gtest/gtest.h>

#include <array>

#include "error_of.h"
#include "features/joined_blocks.h"
#include "features/listed_soups.h"
#include "rounds.h"
#include "tested_backend.h"

namespace crumple::test {
namespace {

const Impacts& find_in(Detector& by, const Part& part, const ImpactQuery& query) { return by.find(part, query); }
const Proximities& find_in(Detector& by, const Part& part, const ProximityQuery& query) { return by.find(part, query); }

/// Returns the query without the arrays that a part already contains.
ImpactQuery of_part(const ImpactQuery& query) { return query; }
ProximityQuery of_part(const ProximityQuery& query) {
    ProximityQuery remaining = query;
    remaining.radii = {};
    remaining.rest = {};
    return remaining;
}

template <class Result, class Query>
void expect_union(const Result& whole, const std::vector<Part>& parts, const Query& query,
                  Detector& searching_detector) {
    Result joined, expected = whole;
    FirstImpact first;
    for (const Part& part : parts) {
        const Result& found = find_in(searching_detector, part, of_part(query));
        joined.count += found.count;
        joined.any = joined.any || found.any;
        for (std::size_t k = 0; k < joined.lists.size(); ++k) {
            Result copy = found;
            EXPECT_TRUE(std::is_sorted(copy.lists[k].pairs.begin(), copy.lists[k].pairs.end()));
            for_each_array(joined.lists[k], copy.lists[k], [](auto& to, auto& from) {
                for (const auto& row : from) to.push_back(row);
            });
        }
        if constexpr (std::is_same_v<Result, Impacts>) {
            const auto key = [](const FirstImpact& f) { return std::tuple(f.toi, f.kind, f.pair); };
            if (found.first.found && (!first.found || key(found.first) < key(first))) first = found.first;
        }
    }
    if constexpr (std::is_same_v<Result, Impacts>) {
        EXPECT_TRUE(first == whole.first);
    }
    EXPECT_EQ(joined.any, whole.any);
    ASSERT_EQ(joined.count, whole.count);
    for (std::size_t k = 0; k < joined.lists.size(); ++k) {
        sort_rows(joined.lists[k]);
        for_each_array(joined.lists[k], expected.lists[k],
                       [](auto& found, auto& all) { ASSERT_TRUE(same_bytes(found, all, "rows")); });
    }
}

Detector& partitioning_detector() {
    static Detector detector({.backend = Backend::cpu, .threads = 2, .leaf_size = 40});
    return detector;
}
// Detector that searches the parts, on the tested backend.
Detector& searching_detector() {
    static Detector detector({.backend = tested_backend, .threads = 1, .clusters = 3, .leaf_size = 10});
    return detector;
}
Detector& by_brute_force() {
    static Detector detector({.backend = Backend::reference});
    return detector;
}

template <class Soup>
std::vector<Part> partition(const Soup& soup, const ImpactQuery& query, int count) {
    return partitioning_detector().partition(soup.view().moving_to(soup.end_view()), query, count);
}
template <class Soup>
std::vector<Part> partition(const Soup& soup, const ProximityQuery& query, int count) {
    return partitioning_detector().partition(soup.view(), query, count);
}
template <class Soup>
Impacts whole(const Soup& soup, const ImpactQuery& query) {
    return partitioning_detector().find(soup.view().moving_to(soup.end_view()), query);
}
template <class Soup>
Proximities whole(const Soup& soup, const ProximityQuery& query) {
    return partitioning_detector().find(soup.view(), query);
}

constexpr std::int64_t most_for_brute_force = 400;
const std::vector<int> numbers_of_parts = played ? std::vector{3} : std::vector{1, 7, 70};
const double share_of_soups = played ? 0.2 : 1;

template <class Soup, class Query>
void expect_union(const Soup& soup, const Query& query) {
    const auto all = whole(soup, query);
    for (const int count : numbers_of_parts) {
        SCOPED_TRACE(testing::Message() << count << " parts");
        const std::vector<Part> parts = partition(soup, query, count);
        ASSERT_EQ(parts.size(), static_cast<std::size_t>(count));
        expect_union(all, parts, query, searching_detector());
        if (count > 1 && count < 10 && all.count < most_for_brute_force)
            expect_union(all, parts, query, by_brute_force());
        if (testing::Test::HasFailure()) return;
    }
}

template <class Scalar>
class PartsOfFeatures : public testing::Test {
   protected:
    template <class Work>
    void for_each_soup(double part, Work work) {
        unsigned seed = 0;
        for (const NamedMove<Scalar>& move : moving_soups<Scalar>(share_of_soups * part * scaled_rounds(10) / 10)) {
            SCOPED_TRACE(move.name);
            work(move, seed++);
            if (this->HasFailure()) return;
        }
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(PartsOfFeatures, Precisions, );

TYPED_TEST(PartsOfFeatures, parts_have_the_impacts_of_the_whole) {
    this->for_each_soup(0.4, [](const auto& move, unsigned) {
        expect_union(move.soup, ImpactQuery{});
        if (move.unit > 1e100) return;
        expect_union(move.soup, ImpactQuery{.min_distance = 0.1 * move.unit, .weld = true});
    });
}

TYPED_TEST(PartsOfFeatures, parts_have_all_impacts_within_a_distance_share) {
    this->for_each_soup(0.2, [](const auto& move, unsigned) {
        if (move.unit < 1e100) expect_union(move.soup, ImpactQuery{.min_distance_share = 0.5});
    });
}

TYPED_TEST(PartsOfFeatures, parts_have_the_proximities_of_the_whole) {
    this->for_each_soup(0.4, [](const auto& move, unsigned) {
        if (move.unit > 1e100) return;
        expect_union(move.soup, ProximityQuery{.radius = 0.5 * move.unit, .closest = true});
        expect_union(move.soup, ProximityQuery{.radius = 0.7 * move.unit, .strict = true, .weld = true, .rings = 1});
        expect_union(move.soup, ProximityQuery{.radius = 0.7 * move.unit, .rings = 2});
    });
}

TYPED_TEST(PartsOfFeatures, parts_have_all_pairs_of_codimensional_features) {
    this->for_each_soup(0.4, [](const auto& move, unsigned seed) {
        if (move.unit > 1e100) return;
        for (unsigned lists = 0; lists < 4; ++lists) {
            if (played && lists != seed % 4) continue;
            const auto soup = with_lists(move.soup, 7 * seed + lists);
            expect_union(soup, ImpactQuery{.min_distance = 0.1 * move.unit, .weld = lists == 2});
            expect_union(
                soup,
                ProximityQuery{.radius = 0.6 * move.unit, .closest = true, .weld = lists == 1, .rings = lists == 3});
        }
    });
}

TYPED_TEST(PartsOfFeatures, parts_apply_radii_and_a_rest_shape) {
    const auto soup = rounded<TypeParam>(moving_grid(5, 60, 70, 3));
    std::vector<double> radii;
    for (std::size_t v = 0; v < soup.start.size(); ++v) radii.push_back(0.1 * static_cast<double>(v % 7));
    const ProximityQuery query{.radii = radii, .closest = true, .rest = soup.end_view(), .rest_radius = 1.5};
    EXPECT_GT(whole(soup, query).count, 300);
    expect_union(soup, query);
}

TYPED_TEST(PartsOfFeatures, parts_respect_group_filters) {
    auto plain = moving_grid(5, 60, 70, 4);
    for (std::size_t t = 0; t < plain.triangles.size(); ++t)
        plain.groups.push_back(static_cast<std::int32_t>(t % 4) - 1);
    for (const bool listed : {false, true}) {
        auto soup = rounded<TypeParam>(plain);
        if (listed) {
            soup = with_lists(soup, 11);
            for (std::size_t t = 0; t < soup.triangles.size(); ++t)
                soup.groups.push_back(static_cast<std::int32_t>(t % 4) - 1);
        }
        std::vector<PairFilter> filters(4);
        filters[0].groups = PairScope::between;
        filters[1].groups = PairScope::within;
        filters[2].excluded_groups = {{-1, 0}, {2, 2}};
        filters[3].bodies = PairScope::between;
        for (std::size_t i = 0; i < filters.size(); ++i) {
            const PairFilter& filter = filters[i];
            const bool in_turn = (i % 2 == 1) == listed;  // half of the queries, for an emulated device
            if (!played || in_turn) expect_union(soup, ImpactQuery{.min_distance = 0.2, .filter = filter});
            if (!played || !in_turn) expect_union(soup, ProximityQuery{.radius = 0.5, .filter = filter});
        }
    }
}

TEST(FeaturePart, offsets_and_least_distances_have_a_row_per_vertex_of_the_part) {
    const auto soup = moving_grid(5, 60, 70, 5);
    for (const std::int32_t rings : {0, 1}) {
        const ProximityQuery query{.radius = 1, .least = true, .rings = rings, .index = true};
        const Proximities all = whole(soup, query);
        std::vector<double> least(soup.start.size(), std::numeric_limits<double>::infinity());
        for (const Part& part : partition(soup, query, 5)) {
            const Proximities& found = searching_detector().find(part, query);
            const PartFeatures& features = *part.features;
            ASSERT_EQ(found.vertex_distance.size(), features.vertices.size());
            ASSERT_EQ(found.edge_distance.size(), features.edges.size());
            ASSERT_EQ(found.vertex_faces().offsets.size(), features.vertices.size() + 1);
            EXPECT_EQ(found.vertex_faces().offsets.front(), 0);
            EXPECT_EQ(found.vertex_faces().offsets.back(),
                      static_cast<std::int64_t>(found.vertex_faces().pairs.size()));
            for (std::size_t v = 0; v < features.vertices.size(); ++v) {
                double& of = least[static_cast<std::size_t>(features.vertices[v])];
                of = std::min(of, found.vertex_distance[v]);
                for (std::int64_t i = found.vertex_faces().offsets[v]; i < found.vertex_faces().offsets[v + 1]; ++i)
                    EXPECT_EQ(found.vertex_faces().pairs[i].a, features.vertices[v]);
            }
        }
        EXPECT_EQ(least, std::vector<double>(all.vertex_distance.begin(), all.vertex_distance.end()));
    }
}

TEST(FeaturePart, parts_outlive_the_mesh) {
    auto soup = moving_grid(6, 40, 30, 3);
    const Impacts all = whole(soup, ImpactQuery{});
    ASSERT_GT(all.count, 50);
    const std::vector<Part> parts = partition(soup, ImpactQuery{}, 3);
    soup = {};
    expect_union(all, parts, ImpactQuery{}, searching_detector());
}

TEST(FeaturePart, parts_can_be_searched_for_the_first_or_any_impact) {
    const auto soup = moving_grid(6, 40, 30, 3);
    for (const Part& part : partition(soup, ImpactQuery{}, 3)) {
        const Impacts all = searching_detector().find(part, ImpactQuery());
        const Impacts& first = searching_detector().find(part, ImpactQuery{.output = Output::first});
        EXPECT_TRUE(first.first == all.first);
        EXPECT_EQ(first.world_first.size(), 1u);
        EXPECT_TRUE(first.vertex_faces().pairs.empty());
        const Impacts& any = searching_detector().find(part, ImpactQuery{.output = Output::any});
        EXPECT_EQ(any.any, all.count > 0);
        EXPECT_TRUE(any.world_hit.empty());
    }
}

/// A query about a part may have smaller distances than the query that the part was made for.
TEST(FeaturePart, parts_also_serve_queries_with_smaller_distances) {
    const auto soup = moving_grid(5, 60, 70, 6);
    const auto parts = partition(soup, ImpactQuery{.min_distance = 1, .min_distance_share = 0.3}, 5);
    expect_union(whole(soup, ImpactQuery{.min_distance = 0.25}), parts, ImpactQuery{.min_distance = 0.25},
                 searching_detector());
    const auto static_parts = partition(soup, ProximityQuery{.radius = 1}, 5);
    expect_union(whole(soup, ProximityQuery{.radius = 0.5}), static_parts, ProximityQuery{.radius = 0.5},
                 searching_detector());
}

std::string message(const Part& part, const ImpactQuery& query) {
    return error_of([&] { searching_detector().find(part, query); }).what();
}
std::string message(const Part& part, const ProximityQuery& query) {
    return error_of([&] { searching_detector().find(part, query); }).what();
}

TEST(FeaturePart, queries_that_do_not_match_the_part_are_rejected) {
    const auto soup = moving_grid(5, 30, 20, 6);
    const Part moving = partition(soup, ImpactQuery{.min_distance = 1}, 2)[0];
    const Part static_part = partition(soup, ProximityQuery{.radius = 1, .rings = 1}, 2)[0];
    const Part plain = partitioning_detector().partition(soup.view(), {}, 2)[0];
    EXPECT_EQ(message(plain, ImpactQuery{}), "the part was not made for a query about features");
    EXPECT_EQ(error_of([&] { searching_detector().find(moving); }).what(),
              std::string("the part was made for a query about features"));
    EXPECT_EQ(message(moving, ProximityQuery{}), "the part was made for a query about motion");
    EXPECT_EQ(message(static_part, ImpactQuery{}), "the part was made for a query about nearness");
    EXPECT_EQ(message(moving, ImpactQuery{.min_distance = 2}),
              "min_distance and min_distance_share must be at most those that the part was made for");
    EXPECT_EQ(message(moving, ImpactQuery{.min_distance_share = 0.5}),
              "min_distance and min_distance_share must be at most those that the part was made for");
    EXPECT_EQ(message(moving, ImpactQuery{.weld = true}), "weld must be as in the query that the part was made for");
    EXPECT_EQ(message(moving, ImpactQuery{.triangle_pairs = true}),
              "triangle_pairs must be false: parts do not support them");
    EXPECT_EQ(message(static_part, ProximityQuery{.radius = 2, .rings = 1}),
              "radius must be at most that of the query that the part was made for");
    EXPECT_EQ(message(static_part, ProximityQuery{.radius = 1}),
              "rings must be as in the query that the part was made for");
    EXPECT_EQ(message(static_part, ProximityQuery{.rest_radius = 1}),
              "rings must be as in the query that the part was made for");
    EXPECT_EQ(message(static_part, ProximityQuery{.rings = 1, .rest_radius = 1}),
              "rest_radius needs a part that was made with a rest shape");
    EXPECT_EQ(message(moving, ImpactQuery{.min_distance = -1}), "min_distance must be finite and 0 or more");
    EXPECT_EQ(error_of([&] { partition(soup, ImpactQuery{}, 0); }).what(),
              std::string("the number of parts must be 1 to 262144"));
    EXPECT_EQ(error_of([&] {
                  Detector({.backend = Backend::reference}).partition(soup.view(), ProximityQuery{.radius = -1}, 1);
              }).what(),
              std::string("radius must be finite and 0 or more"));
}

/// Parts that come from elsewhere may be inconsistent. Checks one inconsistent change at a time.
TEST(FeaturePart, inconsistent_parts_are_rejected) {
    const auto soup = with_lists(moving_grid(5, 40, 40, 6), 4);
    const Part good = partition(soup, ImpactQuery{}, 2)[0];
    ASSERT_GT(good.features->edges.size(), 3u);
    ASSERT_GT(good.features->joined.size(), 0u);
    const auto refused = [&](const char* what, auto change) {
        Part bad = good;
        change(bad, *bad.features);
        const Error error = error_of([&] { searching_detector().find(bad, ImpactQuery()); });
        EXPECT_TRUE(error.code == ErrorCode::invalid_argument || error.code == ErrorCode::index_out_of_range) << what;
    };
    refused("no ends", [](Part&, PartFeatures& f) { f.end = std::vector<double>(); });
    refused("an end too few", [](Part&, PartFeatures& f) { std::get<std::vector<double>>(f.end).pop_back(); });
    refused("a vertex too few", [](Part&, PartFeatures& f) { f.vertices.pop_back(); });
    refused("vertices in no order", [](Part&, PartFeatures& f) { std::swap(f.vertices[0], f.vertices[1]); });
    refused("more faces than triangles", [](Part& p, PartFeatures& f) { f.faces = p.mesh.size() + 1; });
    refused("fewer faces", [](Part&, PartFeatures& f) { --f.faces; });
    refused("an owner too few", [](Part&, PartFeatures& f) { f.owned.pop_back(); });
    refused("an edge beyond", [](Part&, PartFeatures& f) { f.edges_of[0][0] = 1 << 20; });
    refused("an edge before", [](Part&, PartFeatures& f) { f.edges_of[0][0] = -2; });
    refused("an unknown edge", [](Part&, PartFeatures& f) { f.owned[0] |= 8, f.edges_of[0][0] = -1; });
    refused("an edge's end", [](Part&, PartFeatures& f) { f.edge_ends[0].b = -1; });
    refused("edges in no order", [](Part&, PartFeatures& f) { f.edges[1] = f.edges[0]; });
    refused("neighbours of no vertex", [](Part&, PartFeatures& f) { f.joined.clear(); });
    refused("a name", [](Part&, PartFeatures& f) { f.names.assign(f.vertices.size(), 1 << 20); });
    refused("radii", [](Part&, PartFeatures& f) { f.radii = {1}; });
    refused("a triangle", [](Part& p, PartFeatures&) { p.mesh.corners[0] = 1 << 20; });
    refused("a level", [](Part& p, PartFeatures&) { p.levels[0].masks.pop_back(); });
    refused("rings", [](Part&, PartFeatures& f) { f.rings = 1; });
}

/// Radii that come from elsewhere may be invalid.
TEST(FeaturePart, invalid_radii_and_rest_positions_are_rejected) {
    const auto soup = moving_grid(5, 30, 20, 6);
    const std::vector<double> radii(soup.start.size(), 0.5);
    Part part = partition(soup, ProximityQuery{.radii = radii}, 1)[0];
    part.features->radii[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(message(part, ProximityQuery{}), "the radius of vertex 0 must be finite and 0 or more");
    part = partition(soup, ProximityQuery{.rest = soup.end_view(), .rest_radius = 1}, 1)[0];
    part.features->rest[4] = std::numeric_limits<double>::infinity();
    EXPECT_NE(message(part, ProximityQuery{.rest_radius = 1}).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace crumple::test
