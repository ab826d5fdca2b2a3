// Tests of stencils: weights, normals and distances of near pairs and impacts, and their reduction to closest parts.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

#include "crumple/crumple.h"
#include "error_of.h"
#include "soups.h"
#include "tested_backend.h"

namespace crumple {
namespace {

using Point = std::array<double, 3>;
using Points = std::vector<Point>;
using Triangles = std::vector<std::array<std::int32_t, 3>>;

constexpr auto none = static_cast<std::uint8_t>(NormalFrom::none), apart = static_cast<std::uint8_t>(NormalFrom::apart),
               before = static_cast<std::uint8_t>(NormalFrom::before),
               rest = static_cast<std::uint8_t>(NormalFrom::rest);

VertexView view(const Points& points) {
    return rows_of_three(points[0].data(), static_cast<std::int64_t>(points.size()));
}
double length(const Point& p) { return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); }

Points positions(const test::Soup<>& soup) {
    Points points;
    for (const auto& p : soup.vertices) points.push_back({p[0], p[1], p[2]});
    return points;
}

Point weighted_sum(const Stencils& rows, std::size_t i, const Points& x) {
    Point sum{};
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
            sum[axis] += rows.weights[i][k] * x[static_cast<std::size_t>(rows.vertices[i][k])][axis];
    return sum;
}

template <class T>
void expect_same_bytes(const Array<T>& a, const Array<T>& b, const char* name) {
    ASSERT_EQ(a.size(), b.size()) << name;
    EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0) << name;
}
void expect_same(const Stencils& a, const Stencils& b) {
    EXPECT_EQ(a.first, b.first);
    expect_same_bytes(a.vertices, b.vertices, "vertices");
    expect_same_bytes(a.weights, b.weights, "weights");
    expect_same_bytes(a.normals, b.normals, "normals");
    expect_same_bytes(a.distance, b.distance, "distance");
    expect_same_bytes(a.normal_from, b.normal_from, "normal_from");
    expect_same_bytes(a.type, b.type, "type");
    expect_same_bytes(a.multiplicity, b.multiplicity, "multiplicity");
    expect_same_bytes(a.row_of_pair, b.row_of_pair, "row_of_pair");
}

// A triangle in the plane z = 0, and a vertex (of a far, thin triangle) at `p`.
struct VertexAndFace {
    Triangles triangles{{0, 1, 2}, {3, 4, 5}};
    Points at(const Point& p) const { return {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, p, {50, 50, 40}, {50, 51, 40}}; }
};

// Two edges of thin triangles, which cross above each other at (0, 0); the second one has the height z.
struct TwoEdges {
    Triangles triangles{{0, 1, 2}, {3, 4, 5}};
    Points at(double z) const { return {{-1, 0, 0}, {1, 0, 0}, {0, 0, -9}, {0, -1, z}, {0, 1, z}, {0, 0, z + 9}}; }
};

// Returns the row of vertices v, w, ...; the number of rows if there is none.
std::size_t row_of(const Stencils& rows, const std::array<std::int32_t, 4>& vertices) {
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows.vertices[i] == vertices) return i;
    ADD_FAILURE() << "no row of vertices " << vertices[0] << ' ' << vertices[1] << ' ' << vertices[2] << ' '
                  << vertices[3];
    return rows.size();
}

void expect_normal(const Stencils& rows, std::size_t i, const Point& normal, std::uint8_t from) {
    ASSERT_LT(i, rows.size());
    EXPECT_EQ(rows.normal_from[i], from);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(rows.normals[i][axis], normal[axis], 1e-15) << axis;
}

Proximities near(const MeshView& mesh, double radius, bool closest = true) {
    Detector detector({.backend = test::tested_backend});
    return detector.find(mesh, ProximityQuery{.radius = radius, .closest = closest});
}
Impacts impacts(const MeshView& mesh, const Points& end, const ImpactQuery& query = {}) {
    Detector detector({.backend = test::tested_backend});
    return detector.find(mesh.moving_to(view(end)), query);
}

TEST(Stencils, weights_give_the_vector_between_nearest_points) {
    const test::Soup<> sheet = test::wavy_sheet(24, 0.05);
    const Points x = positions(sheet);
    const Proximities found = near(sheet.view(), 0.04);
    const Stencils rows = stencils(sheet.view(), found);
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(found.count));
    ASSERT_GT(found.count, 50);
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const ProximityList& list = found.lists[k];
        ASSERT_EQ(static_cast<std::size_t>(rows.first[k + 1] - rows.first[k]), list.pairs.size());
        for (std::size_t j = 0; j < list.pairs.size(); ++j) {
            const std::size_t i = static_cast<std::size_t>(rows.first[k]) + j;
            const auto [a, b] = list.pairs[j];
            const auto& v = rows.vertices[i];
            if (k == 0) {
                const auto& t = sheet.triangles[static_cast<std::size_t>(b)];
                EXPECT_EQ(v, (std::array{a, t[0], t[1], t[2]}));
            } else {
                EXPECT_EQ(v, (std::array{found.edges[a].a, found.edges[a].b, found.edges[b].a, found.edges[b].b}));
            }
            const auto& w = rows.weights[i];
            const double first = k == 0 ? w[0] : w[0] + w[1];
            EXPECT_NEAR(first, 1, 1e-15);
            EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 0, 1e-15);
            EXPECT_EQ(rows.distance[i], std::sqrt(list.squared_distance[j]));
            EXPECT_EQ(rows.type[i], list.type[j]);
            if (list.touching[j]) {
                EXPECT_EQ(rows.normal_from[i], none);
                EXPECT_EQ(length(rows.normals[i]), 0);
                continue;
            }
            EXPECT_EQ(rows.normal_from[i], apart);
            EXPECT_NEAR(length(rows.normals[i]), 1, 1e-15);
            const Point sum = weighted_sum(rows, i, x);
            for (std::size_t axis = 0; axis < 3; ++axis)
                EXPECT_NEAR(sum[axis], rows.distance[i] * rows.normals[i][axis], 1e-15) << i;
        }
    }
}

TEST(Stencils, closest_threads_and_backends_do_not_change_a_byte) {
    const test::Soup<> sheet = test::random_soup(test::played ? 30 : 100, 0.2);
    const Points before_positions = positions(test::random_soup(test::played ? 30 : 100, 0.2, 2));
    for (const bool reduced : {false, true}) {
        const StencilOptions options{.before = view(before_positions), .reduced = reduced, .parallel = 1e-3};
        const Stencils expected = stencils(sheet.view(), near(sheet.view(), 0.04), options);
        StencilOptions threads = options;
        threads.threads = 3;
        expect_same(stencils(sheet.view(), near(sheet.view(), 0.04, false), threads), expected);
        Detector reference({.backend = Backend::reference});
        expect_same(stencils(sheet.view(), reference.find(sheet.view(), ProximityQuery{.radius = 0.04}), options),
                    expected);
        const MeshView step = sheet.view().moving_to(view(before_positions));
        Detector detector({.backend = test::tested_backend});
        const Stencils moving = stencils(step, detector.find(step, ImpactQuery()), options);
        expect_same(stencils(step, reference.find(step, ImpactQuery()), threads), moving);
        EXPECT_GT(moving.size(), 0U);
    }
}

TEST(Stencils, pair_that_touches_has_its_normal_on_the_side_before) {
    const VertexAndFace scene;
    const Points touching = scene.at({1, 1, 0});
    const MeshView mesh(touching, scene.triangles);
    const Proximities found = near(mesh, 0.5);
    const std::array<std::int32_t, 4> names{3, 0, 1, 2};
    for (const double height : {2.0, -2.0, 1e-9}) {
        const Points earlier = scene.at({3, 0.5, height});
        const Stencils rows = stencils(mesh, found, {.before = view(earlier)});
        expect_normal(rows, row_of(rows, names), {0, 0, height > 0 ? 1.0 : -1.0}, before);
    }
    const Points in_the_plane = scene.at({3, 0.5, 0});
    const Stencils unknown = stencils(mesh, found, {.before = view(in_the_plane)});
    expect_normal(unknown, row_of(unknown, names), {0, 0, 0}, none);
    EXPECT_EQ(unknown.distance[row_of(unknown, names)], 0);
}

TEST(Stencils, rest_shape_decides_by_its_orientation_where_earlier_positions_do_not) {
    const VertexAndFace scene;
    const Points touching = scene.at({1, 1, 0}), in_the_plane = scene.at({3, 0.5, 0});
    Points turned = scene.at({1, 1, 3});
    for (Point& p : turned) p = {p[0], -p[1], -p[2]};  // half a turn about x: the vertex stays on the same side
    const MeshView mesh(touching, scene.triangles);
    const Stencils rows = stencils(mesh, near(mesh, 0.5), {.before = view(in_the_plane), .rest = view(turned)});
    expect_normal(rows, row_of(rows, {3, 0, 1, 2}), {0, 0, 1}, rest);

    const TwoEdges edges;
    const Points crossing = edges.at(0), below = edges.at(-1);
    const MeshView other(crossing, edges.triangles);
    const Proximities found = near(other, 0.5);
    const Stencils first_is_above = stencils(other, found, {.rest = view(below)});
    expect_normal(first_is_above, row_of(first_is_above, {0, 1, 3, 4}), {0, 0, 1}, rest);
}

TEST(Stencils, normal_of_a_vertex_on_an_edge_is_perpendicular_to_the_edge) {
    const VertexAndFace scene;
    const Points touching = scene.at({2, 0, 0}), earlier = scene.at({3, -1, 1});
    const MeshView mesh(touching, scene.triangles);
    const Stencils rows = stencils(mesh, near(mesh, 0.5), {.before = view(earlier)});
    const std::size_t i = row_of(rows, {3, 0, 1, 2});
    expect_normal(rows, i, {0, -std::sqrt(0.5), std::sqrt(0.5)}, before);
    EXPECT_EQ(rows.type[i], static_cast<std::uint8_t>(VertexFaceType::P_E0));
    EXPECT_EQ(rows.weights[i], (std::array{1.0, -0.5, -0.5, 0.0}));
}

TEST(Stencils, vertices_that_touch_have_the_direction_before) {
    const VertexAndFace scene;
    const Points touching = scene.at({0, 0, 0}), earlier = scene.at({-3, 0, 4});
    const MeshView mesh(touching, scene.triangles);
    const Stencils rows = stencils(mesh, near(mesh, 0.5), {.before = view(earlier)});
    expect_normal(rows, row_of(rows, {3, 0, 1, 2}), {-0.6, 0, 0.8}, before);
}

TEST(Stencils, normal_of_an_impact_points_to_the_side_that_the_vertex_came_from) {
    const VertexAndFace scene;
    for (const double height : {1.0, -1.0, 1e-7}) {
        const Points start = scene.at({1, 1, height}), end = scene.at({1.5, 1, -3 * height});
        const MeshView mesh(start, scene.triangles);
        const Stencils rows = stencils(mesh.moving_to(view(end)), impacts(mesh, end));
        const std::size_t i = row_of(rows, {3, 0, 1, 2});
        expect_normal(rows, i, {0, 0, height > 0 ? 1.0 : -1.0}, before);
        EXPECT_NEAR(rows.distance[i], 0, 1e-15);
        EXPECT_NEAR(rows.weights[i][2], -1.125 / 4, 1e-15);  // at x = 1.125, a quarter of the step
    }
}

TEST(Stencils, impact_comes_from_the_side_just_before_it_even_if_the_vertex_starts_on_the_other_side) {
    // The vertex starts above the plane of the face and outside of it. The face turns about the y axis, so the vertex
    // is below the moving plane when it comes in.
    const VertexAndFace scene;
    Points start = scene.at({6, 1, 1}), end = scene.at({0, 1, 1});
    for (std::size_t k = 0; k < 3; ++k) end[k] = {start[k][0], start[k][1], start[k][0]};  // z = x
    const MeshView mesh(start, scene.triangles);
    const Stencils rows = stencils(mesh.moving_to(view(end)), impacts(mesh, end));
    // At the time t the plane is z = t x, and the vertex is at x = 6 - 6 t, z = 1: it meets the plane first at the root
    // of 6 t (1 - t) = 1 below 1/2, where x > 4 is outside; then at the other root, coming from below.
    const double t = (1 + std::sqrt(1 - 2.0 / 3)) / 2;
    const std::size_t i = row_of(rows, {3, 0, 1, 2});
    const double size = std::sqrt(1 + t * t);
    ASSERT_LT(i, rows.size());
    EXPECT_EQ(rows.normal_from[i], before);
    EXPECT_NEAR(rows.normals[i][0], t / size, 1e-14);
    EXPECT_NEAR(rows.normals[i][2], -1 / size, 1e-14);
}

TEST(Stencils, normals_of_random_impacts_point_to_where_the_features_were_just_before) {
    const test::Soup<> soup = test::random_soup(test::played ? 30 : 150, 0.2);
    const Points start = positions(soup), end = positions(test::random_soup(test::played ? 30 : 150, 0.2, 2));
    const MeshView mesh(start, soup.triangles);
    const Impacts found = impacts(mesh, end);
    const Stencils rows = stencils(mesh.moving_to(view(end)), found);
    std::vector<double> times;
    for (const ImpactList& list : found.lists) times.insert(times.end(), list.toi.begin(), list.toi.end());
    ASSERT_EQ(times.size(), rows.size());
    ASSERT_GT(rows.size(), test::played ? 5U : 100U);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows.normal_from[i], before);
        EXPECT_LT(rows.distance[i], 1e-14);
        const double t = times[i] - 1e-7;
        Points x = start;
        for (std::size_t v = 0; v < x.size(); ++v)
            for (std::size_t axis = 0; axis < 3; ++axis) x[v][axis] += t * (end[v][axis] - start[v][axis]);
        const Point apart_before = weighted_sum(rows, i, x);
        double side = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) side += apart_before[axis] * rows.normals[i][axis];
        EXPECT_GT(side, 0) << i;
    }
}

TEST(Stencils, edges_that_meet_have_a_normal_to_both) {
    const TwoEdges edges;
    const Points start = edges.at(1), end = edges.at(-1);
    const MeshView mesh(start, edges.triangles);
    const Stencils rows = stencils(mesh.moving_to(view(end)), impacts(mesh, end));
    expect_normal(rows, row_of(rows, {0, 1, 3, 4}), {0, 0, -1}, before);  // the first edge is below the second one
}

TEST(Stencils, impact_at_a_minimum_distance_has_that_distance) {
    const VertexAndFace scene;
    const Points start = scene.at({1, 1, 1}), end = scene.at({1, 1, -1});
    const MeshView mesh(start, scene.triangles);
    const Stencils rows = stencils(mesh.moving_to(view(end)), impacts(mesh, end, {.min_distance = 0.25}));
    const std::size_t i = row_of(rows, {3, 0, 1, 2});
    expect_normal(rows, i, {0, 0, 1}, apart);
    EXPECT_NEAR(rows.distance[i], 0.25, 1e-15);
}

TEST(Stencils, contact_at_the_start_has_no_side_without_earlier_positions) {
    const VertexAndFace scene;
    const Points start = scene.at({1, 1, 0}), end = scene.at({1, 1, -1}), earlier = scene.at({1, 1, 1});
    const MeshView mesh(start, scene.triangles);
    const Impacts found = impacts(mesh, end);
    const Stencils unknown = stencils(mesh.moving_to(view(end)), found);
    expect_normal(unknown, row_of(unknown, {3, 0, 1, 2}), {0, 0, 0}, none);
    const Stencils rows = stencils(mesh.moving_to(view(end)), found, {.before = view(earlier)});
    expect_normal(rows, row_of(rows, {3, 0, 1, 2}), {0, 0, 1}, before);
}

TEST(Stencils, side_is_right_one_unit_in_the_last_place_from_the_plane) {
    // A slanted face far from the origin, where sums of weighted positions round to nothing.
    const double far = 1e6;
    const VertexAndFace scene;
    for (const double ulps : {-1.0, 1.0}) {
        Points x = scene.at({1, 1, 0});
        for (Point& p : x) p[2] += far + p[0] + 2 * p[1];
        x[3][2] = ulps < 0 ? std::nextafter(x[3][2], 0) : std::nextafter(x[3][2], 2 * far);
        const MeshView mesh(x, scene.triangles);
        const Stencils rows = stencils(mesh, near(mesh, 0.5));
        const double size = std::sqrt(6.0);
        expect_normal(rows, row_of(rows, {3, 0, 1, 2}), {-ulps / size, -2 * ulps / size, ulps / size}, apart);
    }
}

TEST(Stencils, reduced_rows_have_the_energy_of_all_pairs) {
    const test::Soup<> sheet = test::random_soup(test::played ? 60 : 300, 0.2);
    const Proximities found = near(sheet.view(), 0.04);
    const Stencils all = stencils(sheet.view(), found);
    const Stencils rows = stencils(sheet.view(), found, {.reduced = true});
    ASSERT_EQ(rows.row_of_pair.size(), all.size());
    ASSERT_LT(rows.size(), all.size());
    EXPECT_EQ(rows.first.back(), static_cast<std::int64_t>(rows.size()));
    std::vector<std::int32_t> pairs(rows.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows.row_of_pair[i]);
        ASSERT_LT(row, rows.size());
        ++pairs[row];
        EXPECT_EQ(rows.distance[row], all.distance[i]);
        // Equal gradients of the distance: the same weight times the normal at each vertex.
        std::map<std::int32_t, Point> gradient;
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                gradient[all.vertices[i][k]][axis] += all.weights[i][k] * all.normals[i][axis];
                gradient[rows.vertices[row][k]][axis] -= rows.weights[row][k] * rows.normals[row][axis];
            }
        }
        for (const auto& [vertex, difference] : gradient) EXPECT_LT(length(difference), 1e-14) << i;
    }
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        EXPECT_GT(rows.first[k + 1], rows.first[k]) << "all kinds occur";
        for (std::int64_t i = rows.first[k]; i < rows.first[k + 1]; ++i) {
            if (i > rows.first[k]) {
                EXPECT_LT(rows.vertices[i - 1], rows.vertices[i]) << "sorted, each once";
            }
            const std::array<std::uint8_t, 4> whole{6, 8, 2, 0};
            EXPECT_EQ(rows.type[i], whole[k]);
        }
    }
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows.multiplicity[i], pairs[i]);
}

TEST(Stencils, corners_of_two_fans_make_one_row) {
    // Two fans of four triangles each; their tips are near each other.
    Points x{{0, 0, 0}, {2, 0, -1}, {0, 2, -1}, {-2, 0, -1}, {0, -2, -1},
             {0, 0, 1}, {2, 0, 2},  {0, 2, 2},  {-2, 0, 2},  {0, -2, 2}};
    Triangles triangles;
    for (const std::int32_t tip : {0, 5})
        for (std::int32_t k = 0; k < 4; ++k) triangles.push_back({tip, tip + 1 + k, tip + 1 + (k + 1) % 4});
    const MeshView mesh(x, triangles);
    const Stencils rows = stencils(mesh, near(mesh, 1.1), {.reduced = true});
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.first, (std::array<std::int64_t, 5>{0, 0, 0, 0, 1}));
    EXPECT_EQ(rows.vertices[0], (std::array{0, 5, 5, 5}));
    EXPECT_EQ(rows.weights[0], (std::array{1.0, -1.0, 0.0, 0.0}));
    EXPECT_EQ(rows.multiplicity[0], 4 + 4 + 16);  // each tip with four faces, and four edges with four
    expect_normal(rows, 0, {0, 0, -1}, apart);
}

TEST(Stencils, nearly_parallel_edges_stay_edges_on_request) {
    const Points x{{0, 0, 0}, {1, 0, 0}, {0, 0, -9}, {1.25, 0, 0.5}, {2, 0.001, 0.5}, {1.5, 0, 9}};
    const Triangles triangles{{0, 1, 2}, {3, 4, 5}};
    const MeshView mesh(x, triangles);
    const Proximities found = near(mesh, 0.6);
    const auto kind = [&](const StencilOptions& options) {
        return stencils(mesh, found, options).first[static_cast<std::size_t>(FeatureKind::edge_edge) + 1];
    };
    EXPECT_EQ(kind({.reduced = true}), 0);
    EXPECT_EQ(kind({.reduced = true, .parallel = 1e-3}), 1);
    Points short_edges = x;
    short_edges[1] = {0.001, 0, 0};  // in the rest shape the edge is so short that the angle counts as large
    EXPECT_EQ(kind({.rest = view(short_edges), .reduced = true, .parallel = 1e-3}), 0);
    const Stencils rows = stencils(mesh, found, {.reduced = true, .parallel = 1e-3});
    const std::size_t i = row_of(rows, {0, 1, 3, 4});
    ASSERT_LT(i, rows.size());
    EXPECT_EQ(rows.type[i], static_cast<std::uint8_t>(EdgeEdgeType::EA1_EB0));
    EXPECT_EQ(rows.weights[i], (std::array{0.0, 1.0, -1.0, 0.0}));
}

TEST(Stencils, meshes_and_bodies_count_vertices_one_body_after_the_other) {
    const VertexAndFace scene;
    const Points x = scene.at({1, 1, 0.25});
    const Points face(x.begin(), x.begin() + 3), other(x.begin() + 3, x.end());
    const Triangles one{{0, 1, 2}};
    const MeshView whole(x, scene.triangles), a(face, one), b(other, one);
    const Stencils expected = stencils(whole, near(whole, 0.5));
    Detector detector({.backend = test::tested_backend});
    const Stencils of_two =
        stencils(Scene(a, b), detector.find(Scene(a, b), ProximityQuery{.radius = 0.5, .closest = true}));
    EXPECT_EQ(std::vector(of_two.first_vertex.begin(), of_two.first_vertex.end()),
              (std::vector<std::int64_t>{0, 3, 6}));
    ASSERT_EQ(of_two.size(), expected.size());
    expect_normal(of_two, row_of(of_two, {3, 0, 1, 2}), {0, 0, 1}, apart);

    const std::array shapes{Shape(a), Shape(b)};
    const std::array bodies{Body{.shape = 1}, Body{.shape = 0}};
    Pose lifted;
    lifted.rows[11] = 0.125;
    const std::array poses{Pose{}, lifted};
    const World world{shapes, bodies, poses};
    const Stencils of_bodies = stencils(world, detector.find(world, ProximityQuery{.radius = 0.5, .closest = true}));
    const std::size_t i = row_of(of_bodies, {0, 3, 4, 5});
    expect_normal(of_bodies, i, {0, 0, 1}, apart);
    EXPECT_EQ(of_bodies.distance[i], 0.125);
}

TEST(Stencils, rods_and_particles_have_rows_of_their_kinds) {
    const Points x{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0.25}, {0.5, 0, 0.5}};
    MeshView mesh(view(x), TriangleView{});
    const std::array edges{Edge{0, 1}};
    const std::array<std::int32_t, 2> points{3, 2};
    mesh.edges = edges;
    mesh.points = points;
    const Stencils rows = stencils(mesh, near(mesh, 0.3));
    EXPECT_EQ(rows.first, (std::array<std::int64_t, 5>{0, 0, 0, 1, 2}));
    EXPECT_EQ(rows.vertices[0], (std::array{2, 0, 1, 1}));
    EXPECT_EQ(rows.weights[0], (std::array{1.0, -0.5, -0.5, 0.0}));
    EXPECT_EQ(rows.vertices[1], (std::array{3, 2, 2, 2}));
    expect_normal(rows, 0, {0, 0, 1}, apart);
    expect_normal(rows, 1, {0, 0, 1}, apart);
}

TEST(Stencils, results_of_other_scenes_and_wrong_options_are_errors) {
    const VertexAndFace scene;
    const Points x = scene.at({1, 1, 0.25});
    const MeshView mesh(x, scene.triangles);
    const Proximities found = near(mesh, 0.5);
    const auto message = [&](const Scene& of, const StencilOptions& options = {}) {
        const Error error = test::error_of([&] { stencils(of, found, options); });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        return std::string(error.what());
    };
    const Points few(x.begin(), x.begin() + 3);
    const Triangles one{{0, 1, 2}};
    EXPECT_NE(message(MeshView(few, one)).find("pair 0 of kind vertex_face does not fit the scene"), std::string::npos);
    Points broken = x;
    broken[3][0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(message(MeshView(broken, scene.triangles)).find("not finite"), std::string::npos);
    EXPECT_EQ(message(mesh, {.before = view(few)}), "before has 3 rows for 6 vertices");
    EXPECT_EQ(message(mesh, {.rest = view(few)}), "rest has 3 rows for 6 vertices");
    EXPECT_EQ(message(mesh, {.parallel = -1}), "parallel must be finite and 0 or more");
    EXPECT_NE(message(mesh, {.threads = -1}).find("threads"), std::string::npos);
    EXPECT_EQ(test::error_of([&] { stencils(mesh, impacts(mesh, x)); }).what(),
              std::string("stencils of impacts need the positions at the end of the step: pass the scene of the query, "
                          "such as Mesh(start, faces).moving_to(end)"));
}

}  // namespace
}  // namespace crumple
