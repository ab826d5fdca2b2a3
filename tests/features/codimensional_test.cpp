// Tests of codimensional edges and points: rods, hair, particles, and explicit lists of a mesh's features. Compares the
// tested backend with brute force over the lists, and checks what lists mean.

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "error_of.h"
#include "features/listed_soups.h"
#include "features/tested_detectors.h"
#include "rounds.h"

namespace crumple::test {
namespace {

template <class Scalar>
class CodimensionalAgreement : public testing::Test {
   protected:
    template <class Work>
    void for_each_soup(double part, unsigned seeds, Work work) {
        unsigned seed = 0;
        for (const NamedMove<Scalar>& move : soups_to_try<Scalar>(part, 0.6))
            for (unsigned i = 0; i < seeds; ++i, ++seed) {
                SCOPED_TRACE(testing::Message() << move.name << ", lists " << seed);
                work(with_lists(move.soup, seed), move.unit);
                if (this->HasFailure()) return;
            }
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(CodimensionalAgreement, Precisions, PrecisionNames);

TYPED_TEST(CodimensionalAgreement, impacts_match_brute_force) {
    this->for_each_soup(0.5, 4, [](const auto& soup, double) { expect_impacts(soup, {}); });
}
TYPED_TEST(CodimensionalAgreement, welded_impacts_match_brute_force) {
    this->for_each_soup(0.5, 2, [](const auto& soup, double) { expect_impacts(soup, {.weld = true}); });
}
TYPED_TEST(CodimensionalAgreement, impacts_within_a_distance_match_brute_force) {
    this->for_each_soup(0.1, 3, [](const auto& soup, double unit) {
        if (unit > 1e300) return;
        expect_impacts(soup, {.min_distance = 0.75 * unit}, {&tested()[1], &tested()[2]});
        expect_impacts(soup, {.min_distance_share = 0.5}, {&tested()[1]});
        expect_impacts(soup, {.approaching_only = true}, {&tested()[1]});
        expect_impacts(soup, {.min_distance = 0.75 * unit, .approaching_only = true}, {&tested()[1]});
    });
}
TYPED_TEST(CodimensionalAgreement, proximities_match_brute_force) {
    this->for_each_soup(0.4, 3, [](const auto& soup, double unit) {
        if (unit > 1e300 || soup.start.size() > 60) return;
        for (const double radius : {0.0, 1e-3, 1.0}) {
            expect_near(soup, {.radius = radius * unit});
            expect_near(soup, {.radius = radius * unit, .weld = true});
        }
    });
}

using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

template <class List>
Pairs pairs_of(const List& list) {
    Pairs pairs;
    for (const Pair& p : list.pairs) pairs.emplace_back(p.a, p.b);
    return pairs;
}

class CodimensionalFeatures : public testing::TestWithParam<Backend> {
   protected:
    Detector detector_{Options{.backend = GetParam(), .threads = 2}};
    const Proximities& near(const MovingSoup<>& soup, ProximityQuery query = {.radius = 10}) {
        return detector_.find(soup.view(), query);
    }
    static MovingSoup<> points_on_a_line(int n) {
        MovingSoup<> soup;
        for (int i = 0; i < n; ++i) soup.vertex({1.0 * i, 0, 0}, {1.0 * i, 0, 0});
        return soup;
    }
};

TEST_P(CodimensionalFeatures, nearby_points_are_reported_as_vertex_vertex_pairs) {
    MovingSoup<> soup = points_on_a_line(4);
    soup.points = {3, 0, 2};
    const Proximities& all = near(soup);
    EXPECT_EQ(pairs_of(all.vertex_vertices()), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
    EXPECT_EQ(all.count, 3);
    EXPECT_EQ(std::vector<double>(all.vertex_vertices().squared_distance.begin(),
                                  all.vertex_vertices().squared_distance.end()),
              (std::vector<double>{9, 1, 4}));
    EXPECT_EQ(pairs_of(near(soup, {.radius = 1}).vertex_vertices()), (Pairs{{0, 2}}));
}

TEST_P(CodimensionalFeatures, vertices_in_no_triangle_edge_or_point_list_have_no_pairs) {
    MovingSoup<> soup = points_on_a_line(4);
    EXPECT_EQ(near(soup).count, 0);
    soup.edges = {{0, 1}};
    EXPECT_EQ(near(soup).count, 0) << "neither with each other nor with the edge";
    soup.edges.reset();
    soup.triangles = {{0, 1, 2}};
    EXPECT_EQ(near(soup).count, 0) << "nor with the triangle";
}

TEST_P(CodimensionalFeatures, point_listed_twice_gives_two_rows) {
    MovingSoup<> soup = points_on_a_line(2);
    soup.points = {1, 0, 1};
    EXPECT_EQ(pairs_of(near(soup).vertex_vertices()), (Pairs{{0, 1}, {1, 2}})) << "but not with itself";
}

TEST_P(CodimensionalFeatures, listed_points_and_ends_of_edges_pair_with_other_edges) {
    MovingSoup<> soup = points_on_a_line(5);
    soup.edges = {{1, 0}, {1, 2}};
    const Proximities& two = near(soup);
    EXPECT_EQ(pairs_of(two.vertex_edges()), (Pairs{{0, 1}, {2, 0}})) << "vertices of edges are points";
    EXPECT_TRUE(two.edge_edges().pairs.empty());
    soup.points = {4, 2};
    const Proximities& listed = near(soup);
    EXPECT_EQ(pairs_of(listed.vertex_edges()), (Pairs{{0, 0}, {0, 1}, {1, 0}}));
    EXPECT_TRUE(listed.vertex_vertices().pairs.empty()) << "only one of them is on no edge";
    EXPECT_EQ(listed.edges[0], (Edge{1, 0})) << "as it was listed";
}

TEST_P(CodimensionalFeatures, vertex_edge_pairs_covered_by_edge_pairs_are_left_out) {
    MovingSoup<> soup = points_on_a_line(5);
    soup.edges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
    const Proximities& chain = near(soup);
    EXPECT_EQ(pairs_of(chain.edge_edges()), (Pairs{{0, 2}, {0, 3}, {1, 3}}));
    EXPECT_EQ(pairs_of(chain.vertex_edges()), (Pairs{{0, 1}, {4, 2}})) << "only the ends have no other edge";
}

TEST_P(CodimensionalFeatures, only_listed_edges_of_a_mesh_have_pairs) {
    MovingSoup<> soup;
    for (int i = 0; i < 4; ++i) soup.vertex({1.0 * (i % 2), 1.0 * (i / 2), 0}, {});
    soup.vertex({0.5, 0.5, 1}, {});
    soup.vertex({0.5, 0.5, 2}, {});
    soup.end = soup.start;
    soup.triangles = {{0, 1, 3}, {0, 3, 2}};
    soup.edges = {{4, 5}, {3, 2}};
    const Proximities& found = near(soup);
    EXPECT_EQ(pairs_of(found.edge_edges()), (Pairs{{0, 1}}));
    EXPECT_EQ(pairs_of(found.vertex_faces()), (Pairs{{1, 1}, {2, 0}, {4, 0}, {4, 1}, {5, 0}, {5, 1}}))
        << "points are those of faces and edges";
    EXPECT_EQ(pairs_of(found.vertex_edges()), (Pairs{{0, 0}, {1, 0}}))
        << "2 and 3 have an edge, an edge of a face has no pair";
}

TEST_P(CodimensionalFeatures, mesh_has_the_same_pairs_if_all_its_edges_and_points_are_listed) {
    MovingSoup<> soup = moving_grid(4, 30, 24, 7);
    const Impacts plain = detector_.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.index = true});
    const Proximities near_plain =
        detector_.find(soup.view(), ProximityQuery{.radius = 1, .closest = true, .least = true});
    soup.edges = edges_of(soup);
    soup.points.emplace(soup.start.size());
    std::iota(soup.points->begin(), soup.points->end(), 0);
    const Impacts& listed = detector_.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.index = true});
    for (std::size_t k = 0; k < 2; ++k) EXPECT_TRUE(same_list(listed.lists[k], plain.lists[k]));
    EXPECT_EQ(listed.count, plain.count) << "no pairs of other kinds";
    EXPECT_TRUE(same_first(listed.first, plain.first));
    const Proximities& near_listed =
        detector_.find(soup.view(), ProximityQuery{.radius = 1, .closest = true, .least = true});
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_TRUE(same_list(near_listed.lists[k], near_plain.lists[k]));
        EXPECT_TRUE(same_bytes(near_listed.lists[k].at, near_plain.lists[k].at, "parameters"));
    }
    EXPECT_EQ(near_listed.count, near_plain.count) << "no pairs of other kinds";
    EXPECT_TRUE(same_bytes(near_listed.edge_distance, near_plain.edge_distance, "least distances"));

    // Another order only changes the numbering.
    std::reverse(soup.edges->begin(), soup.edges->end());
    std::reverse(soup.points->begin(), soup.points->end());
    const auto edges = static_cast<std::int32_t>(soup.edges->size()),
               points = static_cast<std::int32_t>(soup.points->size());
    Pairs expected[2];
    for (const Pair& p : plain.vertex_faces().pairs) expected[0].emplace_back(points - 1 - p.a, p.b);
    for (const Pair& p : plain.edge_edges().pairs) expected[1].emplace_back(edges - 1 - p.b, edges - 1 - p.a);
    const Impacts& reversed = detector_.find(soup.view().moving_to(soup.end_view()), ImpactQuery());
    for (std::size_t k = 0; k < 2; ++k) {
        std::sort(expected[k].begin(), expected[k].end());
        EXPECT_EQ(pairs_of(reversed.lists[k]), expected[k]);
    }
}

TEST_P(CodimensionalFeatures, closest_points_are_reported_for_points_and_edges) {
    MovingSoup<> soup = points_on_a_line(4);
    soup.start[3] = {0.25, 2, 0};
    soup.start[2] = {0.25, 0, 1};
    soup.edges = {{1, 0}};
    soup.points = {3, 2};
    const Proximities& found = near(soup, {.radius = 9, .closest = true, .least = true});
    ASSERT_EQ(pairs_of(found.vertex_edges()), (Pairs{{0, 0}, {1, 0}}));
    EXPECT_EQ(found.vertex_edges().type[0], static_cast<std::uint8_t>(VertexEdgeType::P_E));
    EXPECT_EQ(found.vertex_edges().at[0], (std::array{0.75, 0.0})) << "from the edge's first vertex as listed";
    ASSERT_EQ(pairs_of(found.vertex_vertices()), (Pairs{{0, 1}}));
    EXPECT_EQ(found.vertex_vertices().type[0], static_cast<std::uint8_t>(VertexVertexType::P_P));
    EXPECT_EQ(found.vertex_vertices().squared_distance[0], 5);
    EXPECT_EQ(std::vector<double>(found.vertex_distance.begin(), found.vertex_distance.end()),
              (std::vector<double>{2, 1}));
    EXPECT_EQ(std::vector<double>(found.edge_distance.begin(), found.edge_distance.end()), (std::vector<double>{1}));
}

/// Compares the squares of least distances with the least of the listed squared distances, with a tolerance for
/// rounding.
TEST_P(CodimensionalFeatures, least_distances_are_minima_over_all_kinds_of_pairs) {
    for (unsigned seed = 1; seed < 20; ++seed) {
        const MovingSoup<> soup = with_lists(moving_grid(6, 30, 20, seed), 7 * seed + 1);
        const Proximities& found = near(soup, {.radius = 3.5, .least = true});
        std::vector<double> point(found.vertex_distance.size(), HUGE_VAL), edge(found.edge_distance.size(), HUGE_VAL),
            face(found.face_distance.size(), HUGE_VAL);
        const auto lower = [](std::vector<double>& of, std::int32_t i, double square) {
            double& least = of[static_cast<std::size_t>(i)];
            least = std::min(least, square);
        };
        for (std::size_t k = 0; k < feature_kinds; ++k)
            for (std::size_t i = 0; i < found.lists[k].pairs.size(); ++i) {
                const Pair p = found.lists[k].pairs[i];
                const double square = found.lists[k].squared_distance[i];
                lower(k == 1 ? edge : point, p.a, square);
                lower(k == 0 ? face : k == 3 ? point : edge, p.b, square);
            }
        const auto expect = [&](const Array<double>& distance, const std::vector<double>& squares) {
            for (std::size_t i = 0; i < squares.size(); ++i) {
                EXPECT_EQ(std::isinf(distance[i]), std::isinf(squares[i]));
                if (std::isinf(squares[i])) continue;
                EXPECT_NEAR(distance[i] * distance[i], squares[i], 1e-9);
            }
        };
        expect(found.vertex_distance, point);
        expect(found.edge_distance, edge);
        expect(found.face_distance, face);
    }
}

TEST_P(CodimensionalFeatures, free_step_stops_particles_before_they_touch) {
    MovingSoup<> soup;
    soup.vertex({0, 0, 0}, {1, 0, 0});
    soup.vertex({1, 0, 0}, {0, 0, 0});
    soup.points = {0, 1};
    const FirstImpact first = detector_.find(soup.view().moving_to(soup.end_view()), FirstImpactQuery());
    ASSERT_TRUE(first.found);
    EXPECT_EQ(first.kind, FeatureKind::vertex_vertex);
    EXPECT_EQ(first.toi, 0.5);
    EXPECT_TRUE(detector_.any(soup.view().moving_to(soup.end_view()), ImpactQuery()));
    const FreeStep step = detector_.find(soup.view().moving_to(soup.end_view()), FreeStepQuery());
    EXPECT_GT(step.share, 0.49);
    EXPECT_LT(step.share, 0.5);
    soup.points = {0};
    EXPECT_EQ(detector_.find(soup.view().moving_to(soup.end_view()), FreeStepQuery()).share, 1);
}

TEST_P(CodimensionalFeatures, invalid_edge_and_point_lists_are_rejected) {
    const auto error = [&](std::vector<Edge> edges, std::vector<std::int32_t> points) {
        MovingSoup<> soup = points_on_a_line(4);
        soup.edges = std::move(edges);
        soup.points = std::move(points);
        return error_of([&] { detector_.find(soup.view(), ProximityQuery{.radius = 1}); });
    };
    const auto expect = [](const Error& e, ErrorCode code, Element element, std::int64_t index, const char* message) {
        EXPECT_EQ(e.code, code);
        EXPECT_EQ(e.element, element);
        EXPECT_EQ(e.index, index);
        EXPECT_STREQ(e.what(), message);
    };
    expect(error({{0, 1}, {2, 2}}, {}), ErrorCode::invalid_argument, Element::edge, 1,
           "edge 1 has vertex 2 at both ends");
    expect(error({{0, 1}, {1, 2}, {2, 4}}, {}), ErrorCode::index_out_of_range, Element::edge, 2,
           "edge 2 names vertex 4 of 4");
    expect(error({{-1, 0}}, {}), ErrorCode::index_out_of_range, Element::edge, 0, "edge 0 names vertex -1 of 4");
    expect(error({}, {0, 4}), ErrorCode::index_out_of_range, Element::point, 1, "point 1 names vertex 4 of 4");
    expect(error({}, {-2}), ErrorCode::index_out_of_range, Element::point, 0, "point 0 names vertex -2 of 4");

    MovingSoup<> soup = points_on_a_line(2);
    soup.edges = {{1, 1}};
    const Shape shape(soup.view());
    const std::vector<Body> bodies(2, Body{.self = true});
    EXPECT_STREQ(error_of([&] {
                     detector_.find(World{{&shape, 1}, bodies, {}, {}}, ProximityQuery{.radius = 1});
                 }).what(),
                 "body 0: edge 0 has vertex 1 at both ends");
}

/// Compares bodies with and without lists with one soup that has all features listed.
TEST_P(CodimensionalFeatures, features_are_numbered_within_their_body) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE(seed);
        std::vector<MovingSoup<>> soups;
        std::vector<Shape> shapes;
        std::vector<Body> bodies;
        MovingSoup<> all;
        all.edges.emplace();
        all.points.emplace();
        std::vector<std::int32_t> first_vertex, first_edge, first_point, first_triangle;
        for (unsigned b = 0; b < 4; ++b)
            soups.push_back(with_lists(moving_grid(4, 12, 10, 10 * seed + b), seed + 7 * b));
        for (const MovingSoup<>& soup : soups) {
            bodies.push_back({.shape = static_cast<std::int32_t>(shapes.size()), .self = true});
            shapes.emplace_back(soup.view());
            shapes.back().end = soup.end_view();
            const auto first = static_cast<std::int32_t>(all.start.size());
            first_vertex.push_back(first);
            first_triangle.push_back(static_cast<std::int32_t>(all.triangles.size()));
            first_edge.push_back(static_cast<std::int32_t>(all.edges->size()));
            first_point.push_back(static_cast<std::int32_t>(all.points->size()));
            std::set<std::int32_t> named;
            for (const auto& t : soup.triangles) named.insert(t.begin(), t.end());
            for (const Edge& e : soup.edges ? *soup.edges : edges_of(soup)) {
                all.edges->push_back({first + e.a, first + e.b});
                named.insert({e.a, e.b});
            }
            if (soup.points)
                for (const std::int32_t v : *soup.points) all.points->push_back(first + v);
            else
                for (const std::int32_t v : named) all.points->push_back(first + v);
            all.append(soup);
        }
        const auto body_of = [](const std::vector<std::int32_t>& first, std::int32_t i) {
            return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), i) - first.begin()) - 1;
        };
        using Row = std::array<double, 6>;
        const auto rows_of = [&](const auto& list) {
            std::vector<Row> rows;
            for (std::size_t i = 0; i < list.pairs.size(); ++i)
                rows.push_back({static_cast<double>(list.bodies[i].first), static_cast<double>(list.pairs[i].a),
                                static_cast<double>(list.bodies[i].second), static_cast<double>(list.pairs[i].b),
                                values_of(list)[i], static_cast<double>(flags_of(list)[i])});
            return rows;
        };
        const auto expect_rows = [&](const auto& found, const auto& expected) {
            std::size_t count = 0;
            for (std::size_t k = 0; k < feature_kinds; ++k) {
                const auto& list = expected.lists[k];
                std::vector<Row> rows;
                for (std::size_t i = 0; i < list.pairs.size(); ++i) {
                    const auto place = [&](bool edge, std::int32_t e) {
                        if (edge) {
                            const std::size_t b = body_of(first_edge, e);
                            return std::pair(b, e - first_edge[b]);
                        }
                        const std::int32_t v = (*all.points)[static_cast<std::size_t>(e)];
                        const std::size_t b = body_of(first_vertex, v);
                        return std::pair(b, soups[b].points ? e - first_point[b] : v - first_vertex[b]);
                    };
                    const auto [p, a] = place(k == 1, list.pairs[i].a);
                    auto [q, b] = k == 0 ? std::pair(body_of(first_triangle, list.pairs[i].b), 0)
                                         : place(k != 3, list.pairs[i].b);
                    if (k == 0) b = list.pairs[i].b - first_triangle[q];
                    rows.push_back({static_cast<double>(p), static_cast<double>(a), static_cast<double>(q),
                                    static_cast<double>(b), values_of(list)[i],
                                    static_cast<double>(flags_of(list)[i])});
                }
                std::sort(rows.begin(), rows.end());
                EXPECT_EQ(rows_of(found.lists[k]), rows);
                count += rows.size();
            }
            EXPECT_GT(count, 0U);
        };
        const World world{shapes, bodies, {}, {}};
        Detector single({.backend = tested_backend});
        expect_rows(detector_.find(world, ImpactQuery()),
                    single.find(all.view().moving_to(all.end_view()), ImpactQuery()));
        expect_rows(detector_.find(world, ProximityQuery{.radius = 1, .weld = true}),
                    single.find(all.view(), ProximityQuery{.radius = 1, .weld = true}));
        if (HasFailure()) return;
    }
}

/// Features that no triangle uses belong to their body, but to no group of triangles.
TEST_P(CodimensionalFeatures, edges_and_points_have_the_groups_of_their_triangles_or_body) {
    MovingSoup<> mesh;
    for (int i = 0; i < 6; ++i) mesh.vertex({1.0 * (i % 2), 1.0 * (i / 2 % 2), 0.1 * (i / 3)}, {});
    mesh.vertex({0.5, 0.5, 0.5}, {});
    mesh.vertex({0.5, 0.5, 0.7}, {});
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    mesh.groups = {4, 5};
    mesh.points = {6, 7, 0, 0};
    ProximityQuery query{.radius = 10};
    query.filter.groups = PairScope::between;
    const Proximities& between = near(mesh, query);
    EXPECT_EQ(pairs_of(between.vertex_faces()), (Pairs{{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 1}, {3, 1}}));
    EXPECT_EQ(pairs_of(between.vertex_vertices()), (Pairs{{0, 1}}));

    mesh.edges = {{0, 1}, {1, 0}, {3, 4}, {6, 7}};
    query.filter.groups = PairScope::within;
    const Proximities& within = near(mesh, query);
    EXPECT_EQ(pairs_of(within.vertex_faces()), (Pairs{{0, 0}, {0, 1}, {1, 0}, {1, 1}}))
        << "what is listed twice is of its triangle's group both times";
    EXPECT_EQ(pairs_of(within.edge_edges()), (Pairs{{0, 3}, {1, 3}, {2, 3}}));

    // Without groups of triangles, all features of a body are in the body's group.
    MovingSoup<> dust = mesh;
    dust.triangles = {};
    dust.groups = {};
    dust.edges.reset();
    dust.points = {6};
    const std::array shapes{Shape(dust.view())};
    const std::array bodies{Body{.shape = 0, .group = 1, .self = true}, Body{.shape = 0, .group = 1, .self = true},
                            Body{.shape = 0, .group = 2, .self = true}};
    query.filter.groups = PairScope::between;
    const Proximities& found = detector_.find(World{shapes, bodies, {}, {}}, query);
    const auto& list = found.vertex_vertices();
    ASSERT_EQ(list.pairs.size(), 2U);
    EXPECT_EQ(list.bodies[0], (BodyPair{0, 2}));
    EXPECT_EQ(list.bodies[1], (BodyPair{1, 2}));
    EXPECT_EQ(found.points.size(), 3U);
    EXPECT_EQ(found.first_point.back(), 3);
}

TEST_P(CodimensionalFeatures, results_follow_edge_and_point_lists_that_change_between_calls) {
    MovingSoup<> soup = points_on_a_line(5);
    soup.points = {0, 1, 2};
    EXPECT_EQ(near(soup).count, 3);
    soup.points = {0, 1, 3};
    EXPECT_EQ(near(soup, {.radius = 1.5}).count, 1);
    soup.points.reset();
    soup.edges = {{0, 1}, {2, 3}};
    EXPECT_EQ(pairs_of(near(soup).edge_edges()), (Pairs{{0, 1}}));
    soup.edges = {{0, 1}, {3, 2}, {2, 4}};
    EXPECT_EQ(near(soup).edges[1], (Edge{3, 2}));
    soup.edges.emplace();
    EXPECT_EQ(near(soup).count, 0);
    soup.edges.reset();
    soup.triangles = {{0, 1, 2}, {3, 4, 3}};
    EXPECT_EQ(near(soup).vertex_faces().pairs.size(), 5U);
}

INSTANTIATE_TEST_SUITE_P(Backends, CodimensionalFeatures, testing::ValuesIn(tested_backends), name_of_backend);

}  // namespace
}  // namespace crumple::test
