// Tests of proximity queries on small scenes.

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "crumple/crumple.h"

namespace crumple {
namespace {

using Vertices = std::vector<std::array<double, 3>>;
using Triangles = std::vector<std::array<std::int32_t, 3>>;

constexpr double none = std::numeric_limits<double>::infinity();

// A small triangle 0.5 above a large one, away from its centre.
struct Two {
    Vertices vertices{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {1, 2, 0.5}, {3, 2, 1}, {1, 4, 1}};
    Triangles triangles{{0, 1, 2}, {3, 4, 5}};
    MeshView mesh{vertices, triangles};
};

class ProximityQueries : public testing::TestWithParam<Backend> {
   protected:
    Detector detector{[] {
        Options options;
        options.backend = GetParam();
        return options;
    }()};
};

TEST_P(ProximityQueries, pairs_and_squared_distances_are_listed) {
    const Two two;
    const Proximities& nearby = detector.find(two.mesh, ProximityQuery{.radius = 0.5});
    ASSERT_EQ(nearby.vertex_faces().pairs.size(), 1);
    EXPECT_EQ(nearby.vertex_faces().pairs[0], (Pair{3, 0}));
    EXPECT_EQ(nearby.vertex_faces().squared_distance[0], 0.25);
    EXPECT_EQ(nearby.vertex_faces().touching[0], 0);
    EXPECT_EQ(nearby.edge_edges().pairs.size(), 0);
    EXPECT_EQ(nearby.count, 1);
    EXPECT_FALSE(detector.find(two.mesh, ProximityQuery{.radius = 0.5, .strict = true}).any);
    EXPECT_TRUE(detector.find(two.mesh, ProximityQuery{.output = Output::any, .radius = 0.5}).any);
}

TEST_P(ProximityQueries, closest_points_are_reported) {
    const Two two;
    const Proximities& nearby = detector.find(two.mesh, ProximityQuery{.radius = 1.1, .closest = true});
    const ProximityList& faces = nearby.vertex_faces();
    ASSERT_EQ(faces.pairs.size(), 3);
    ASSERT_EQ(faces.type.size(), 3);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(faces.pairs[i], (Pair{static_cast<std::int32_t>(3 + i), 0}));
        EXPECT_EQ(faces.type[i], static_cast<std::uint8_t>(VertexFaceType::P_T));
        EXPECT_EQ(faces.at[i], (std::array{two.vertices[3 + i][0] / 8, two.vertices[3 + i][1] / 8}));
    }
    // The ends of the edge from (1, 2, 0.5) to (1, 4, 1) are at distances 1.118 and 1.414 from the edge along the y
    // axis.
    const ProximityList& edges = detector.find(two.mesh, ProximityQuery{.radius = 1.12, .closest = true}).edge_edges();
    ASSERT_EQ(edges.pairs.size(), 2);  // pairs with the two edges that end there
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(edges.squared_distance[i], 1.25);
        EXPECT_EQ(edges.type[i], static_cast<std::uint8_t>(EdgeEdgeType::EA_EB0));
        EXPECT_EQ(edges.at[i], (std::array{0.25, 0.0}));
    }
}

TEST_P(ProximityQueries, least_distance_of_each_feature_is_reported) {
    const Two two;
    const Proximities& nearby = detector.find(two.mesh, ProximityQuery{.radius = 1.12, .least = true});
    const auto list = [](const Array<double>& values) { return std::vector<double>(values.begin(), values.end()); };
    EXPECT_EQ(list(nearby.vertex_distance), (std::vector{none, none, none, 0.5, 1.0, 1.0}));
    EXPECT_EQ(list(nearby.face_distance), (std::vector{0.5, none}));
    ASSERT_EQ(nearby.edge_distance.size(), 6);
    const double root = 0x1.1e3779b97f4a7p+0;  // square root of 1.25, rounded down
    EXPECT_EQ(list(nearby.edge_distance), (std::vector{none, root, none, root, root, none}));
    EXPECT_TRUE(detector.find(two.mesh, ProximityQuery{.radius = 1}).vertex_distance.empty());
}

TEST_P(ProximityQueries, index_lists_vertex_face_pairs_by_vertex_and_by_face) {
    const Two two;
    const ProximityList& faces = detector.find(two.mesh, ProximityQuery{.radius = 1.1, .index = true}).vertex_faces();
    const auto list = [](const Array<std::int64_t>& values) {
        return std::vector<std::int64_t>(values.begin(), values.end());
    };
    EXPECT_EQ(list(faces.offsets), (std::vector<std::int64_t>{0, 0, 0, 0, 1, 2, 3}));
    EXPECT_EQ(list(faces.second_offsets), (std::vector<std::int64_t>{0, 3, 3}));
    EXPECT_EQ(list(faces.by_second), (std::vector<std::int64_t>{0, 1, 2}));
    // Vertices 0, 1, 2 pair with face 1, and 3, 4, 5 with face 0.
    const ProximityList& all = detector.find(two.mesh, ProximityQuery{.radius = 100, .index = true}).vertex_faces();
    EXPECT_EQ(list(all.offsets), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(list(all.second_offsets), (std::vector<std::int64_t>{0, 3, 6}));
    EXPECT_EQ(list(all.by_second), (std::vector<std::int64_t>{3, 4, 5, 0, 1, 2}));
}

INSTANTIATE_TEST_SUITE_P(, ProximityQueries, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& p) { return p.param == Backend::cpu ? "cpu" : "reference"; });

}  // namespace
}  // namespace crumple
