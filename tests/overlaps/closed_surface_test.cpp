// Tests of closed and open surfaces, and of the order of a surface's vertices, in which the winding numbers of another
// surface change in few steps.

#include "scene/closed_surface.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

#include "error_of.h"
#include "search/overlap/overlap_row.h"

namespace crumple {
namespace {

struct Mesh {
    std::int64_t vertices;
    std::vector<std::int32_t> triangles;
    ClosedSurface surface{nullptr};

    Mesh(std::int64_t n, std::vector<std::int32_t> t) : vertices(n), triangles(std::move(t)) {
        const std::vector<double> xyz(static_cast<std::size_t>(3 * n), 0.0);
        ParallelFor workers;
        SceneBuffers buffers;
        const MeshView view(xyz.data(), n, triangles.data(), static_cast<std::int64_t>(triangles.size() / 3));
        surface.prepare(prepare_scene(view, nullptr, false, workers, buffers), workers);
    }
};

std::vector<std::int32_t> tetrahedron(std::int32_t first) {
    std::vector<std::int32_t> t{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    for (std::int32_t& v : t) v += first;
    return t;
}

TEST(ClosedSurface, tetrahedron_is_closed_only_with_all_faces) {
    EXPECT_TRUE(Mesh(4, tetrahedron(0)).surface.closed());
    EXPECT_TRUE(Mesh(4, tetrahedron(0)).surface.open_edges().empty());
    std::vector<std::int32_t> open = tetrahedron(0);
    open.resize(9);
    const Mesh mesh(4, open);
    EXPECT_FALSE(mesh.surface.closed());
    const Array<OpenEdge> edges = mesh.surface.open_edges();
    ASSERT_EQ(edges.size(), 3u);
    EXPECT_EQ(edges[0].edge, (Edge{0, 2}));
    EXPECT_EQ(edges[0].triangle, 0);
    EXPECT_EQ(edges[2].edge, (Edge{2, 3}));
    EXPECT_EQ(edges[2].triangle, 2);
    for (std::ptrdiff_t face = 0; face < 4; ++face) {
        std::vector<std::int32_t> others = tetrahedron(0);
        others.erase(others.begin() + 3 * face, others.begin() + 3 * face + 3);
        EXPECT_FALSE(Mesh(4, others).surface.closed()) << "without face " << face;
    }
}

TEST(OpenEdges, open_edges_are_sorted_and_name_the_lowest_triangle) {
    const std::vector<float> xyz{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::vector<std::int32_t> triangles = tetrahedron(0);
    const auto list = [&](bool weld = false) {
        const auto count = static_cast<std::int64_t>(triangles.size() / 3);
        const Array<OpenEdge> open = open_edges(MeshView(xyz.data(), 4, triangles.data(), count), weld);
        return std::vector<OpenEdge>(open.begin(), open.end());
    };
    EXPECT_TRUE(list().empty());
    std::swap(triangles[10], triangles[11]);  // reverses the last triangle, whose edges then run as in adjacent ones
    EXPECT_EQ(list(), (std::vector<OpenEdge>{{{0, 2}, 0}, {{0, 3}, 1}, {{2, 3}, 2}}));
    triangles = {0, 1, 2};
    EXPECT_EQ(list(), (std::vector<OpenEdge>{{{0, 1}, 0}, {{0, 2}, 0}, {{1, 2}, 0}}));
    triangles.clear();
    EXPECT_TRUE(list().empty());
    triangles = {0, 1, 4};
    EXPECT_EQ(test::error_of([&] { list(); }).code, ErrorCode::index_out_of_range);
}

TEST(OpenEdges, welding_closes_seams) {
    std::vector<double> xyz;
    std::vector<std::int32_t> triangles;
    for (const std::int32_t corner : tetrahedron(0)) {
        for (int axis = 0; axis < 3; ++axis) xyz.push_back(corner == axis + 1);
        triangles.push_back(static_cast<std::int32_t>(triangles.size()));
    }
    const MeshView mesh(xyz.data(), 12, triangles.data(), 4);
    EXPECT_EQ(open_edges(mesh).size(), 12u);
    EXPECT_TRUE(open_edges(mesh, true).empty());
    const Array<OpenEdge> of_three = open_edges(MeshView(xyz.data(), 12, triangles.data(), 3), true);
    ASSERT_EQ(of_three.size(), 3u);
    EXPECT_EQ(of_three[0], (OpenEdge{{0, 1}, 0})) << "by the lowest of equal vertices";
}

TEST(ClosedSurface, surface_is_closed_iff_opposite_edges_balance) {
    EXPECT_TRUE(Mesh(3, {0, 1, 2, 0, 2, 1}).surface.closed());   // two faces back to back
    EXPECT_FALSE(Mesh(3, {0, 1, 2, 0, 1, 2}).surface.closed());  // two copies of one face
    EXPECT_TRUE(Mesh(4, {0, 1, 2, 0, 2, 1, 3, 3, 1}).surface.closed() ==
                Mesh(4, {0, 1, 2, 0, 2, 1}).surface.closed());  // degenerate: its edges 31 and 13 cancel
    EXPECT_TRUE(Mesh(0, {}).surface.closed());
}

TEST(ClosedSurface, places_of_a_component_are_contiguous_and_omit_unused_vertices) {
    std::vector<std::int32_t> triangles = tetrahedron(1);
    for (const std::int32_t v : tetrahedron(6)) triangles.push_back(v);
    const Mesh mesh(10, triangles);  // no face has the vertices 0 and 5
    EXPECT_EQ(mesh.surface.places(), 8);
    ASSERT_EQ(mesh.surface.components().size(), 3u);
    EXPECT_EQ(mesh.surface.components()[1], 4);
    EXPECT_EQ(mesh.surface.place(0), -1);
    EXPECT_EQ(mesh.surface.place(5), -1);
    std::set<std::int32_t> places;
    for (const std::int32_t v : {1, 2, 3, 4}) places.insert(mesh.surface.place(v));
    EXPECT_EQ(places, (std::set<std::int32_t>{0, 1, 2, 3}));
    places.clear();
    for (const std::int32_t v : {6, 7, 8, 9}) places.insert(mesh.surface.place(v));
    EXPECT_EQ(places, (std::set<std::int32_t>{4, 5, 6, 7}));
    EXPECT_EQ(mesh.surface.faces(0, 4).size(), 4u);
    EXPECT_EQ(mesh.surface.faces(0, 8).size(), 8u);
}

// Gives vertices random winding numbers, uses their differences along edges as jumps, and expects the numbers back.
TEST(ClosedSurface, winding_numbers_follow_from_jumps_along_edges) {
    std::mt19937 random(3);
    for (int round = 0; round < 50; ++round) {
        const std::int32_t n = 4 + static_cast<std::int32_t>(random() % 40);
        std::vector<std::int32_t> triangles;
        for (std::int32_t t = 0; t < 2 * n; ++t)
            for (int k = 0; k < 3; ++k)
                triangles.push_back(static_cast<std::int32_t>(random() % static_cast<unsigned>(n)));
        const Mesh mesh(n, triangles);
        std::vector<std::int32_t> winding(static_cast<std::size_t>(n));
        for (std::int32_t& w : winding) w = static_cast<std::int32_t>(random() % 3) - 1;
        const auto of = [&](std::int32_t v) { return winding[static_cast<std::size_t>(v)]; };

        WindingSteps steps;
        const auto& first = mesh.surface.components();
        for (std::size_t c = 0; c + 1 < first.size(); ++c)
            steps.add(first[c], first[c + 1], of(mesh.surface.vertex_at_place(first[c])));
        for (std::int32_t t = 0; t < 2 * n; ++t) {
            const std::int32_t* c = mesh.surface.corners(t);
            EdgeJumps jumps;
            for (std::size_t k = 0; k < 3; ++k) jumps[k] = of(c[(k + 1) % 3]) - of(c[k]);
            steps.add_jumps(mesh.surface, t, jumps);
        }
        steps.make_intervals();
        std::vector<std::int32_t> found(static_cast<std::size_t>(mesh.surface.places()), 0);
        for (const WindingInterval& interval : steps.intervals())
            for (std::int32_t p = interval.begin; p < interval.end; ++p)
                found[static_cast<std::size_t>(p)] = interval.winding;
        for (std::int32_t p = 0; p < mesh.surface.places(); ++p)
            ASSERT_EQ(found[static_cast<std::size_t>(p)], of(mesh.surface.vertex_at_place(p)));
    }
}

}  // namespace
}  // namespace crumple
