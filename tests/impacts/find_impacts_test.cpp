// Tests of impact queries on whole scenes.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "crumple/crumple.h"

namespace crumple {
namespace {

using Vertices = std::vector<std::array<double, 3>>;
using Triangles = std::vector<std::array<std::int32_t, 3>>;

// A triangle whose lowest corner falls through another triangle; its other corners stay above.
struct Falling {
    Vertices start{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {2, 1, 2}, {1, 2, 2}};
    Vertices end{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {2, 1, 0.5}, {1, 2, 0.5}};
    Triangles triangles{{0, 1, 2}, {3, 4, 5}};
};

VertexView view(const Vertices& vertices) {
    return {vertices.data(), static_cast<std::int64_t>(vertices.size()), 24, 8, ScalarType::float64};
}

class ImpactQueries : public testing::TestWithParam<Backend> {
   protected:
    Detector detector{[] {
        Options options;
        options.backend = GetParam();
        return options;
    }()};
};

TEST_P(ImpactQueries, vertex_face_pair_and_time_of_impact_are_reported) {
    const Falling scene;
    const Impacts& impacts =
        detector.find((MeshView(scene.start, scene.triangles)).moving_to(view(scene.end)), ImpactQuery());
    ASSERT_EQ(impacts.vertex_faces().pairs.size(), 1);
    EXPECT_EQ(impacts.vertex_faces().pairs[0], (Pair{3, 0}));
    EXPECT_EQ(impacts.vertex_faces().toi[0], 0.5);
    EXPECT_EQ(impacts.vertex_faces().start[0], 0);
    EXPECT_EQ(impacts.edge_edges().pairs.size(), 0);
    EXPECT_TRUE(impacts.any);
    EXPECT_EQ(impacts.edges.size(), 6);
}

TEST_P(ImpactQueries, first_impact_is_reported_or_none_if_the_step_is_free) {
    Falling scene;
    scene.end[4] = {2, 1, -6};  // reaches the other triangle at t = 1/4, before vertex 3
    const MeshView mesh(scene.start, scene.triangles);
    EXPECT_EQ(detector.find(mesh.moving_to(view(scene.end)), ImpactQuery()).vertex_faces().pairs.size(), 2);
    const FirstImpact first = detector.find(mesh.moving_to(view(scene.end)), FirstImpactQuery());
    EXPECT_TRUE(first.found);
    EXPECT_EQ(first.toi, 0.25);
    EXPECT_EQ(first.kind, FeatureKind::vertex_face);
    EXPECT_EQ(first.pair, (Pair{4, 0}));
    EXPECT_TRUE(detector.any(mesh.moving_to(view(scene.end)), ImpactQuery()));
    EXPECT_FALSE(detector.any(mesh.moving_to(view(scene.start)), ImpactQuery()));
    EXPECT_FALSE(detector.find(mesh.moving_to(view(scene.start)), FirstImpactQuery()).found);
}

TEST_P(ImpactQueries, free_step_ends_before_the_first_contact) {
    Falling scene;
    scene.end[4] = {2, 1, -6};  // reaches the other triangle at t = 1/4, before vertex 3
    const MeshView mesh(scene.start, scene.triangles);
    const FreeStep step = detector.find(mesh.moving_to(view(scene.end)), FreeStepQuery());
    EXPECT_EQ(step.share, 0.25 * (1 - 0x1p-16));
    EXPECT_EQ(step.positions[3 * 4 + 2], 0x1p-15);
    EXPECT_FALSE(detector.any(mesh.moving_to({step.positions.data(), 6, 24, 8, ScalarType::float64}), ImpactQuery()));

    const FreeStep whole = detector.find(mesh.moving_to(view(scene.start)), FreeStepQuery());
    EXPECT_EQ(whole.share, 1);
    EXPECT_EQ(whole.positions[3 * 3 + 2], 1);
}

TEST_P(ImpactQueries, free_step_is_zero_if_features_touch_at_the_start) {
    Falling scene;
    scene.start[3] = {1, 1, 0};
    const FreeStep step =
        detector.find((MeshView(scene.start, scene.triangles)).moving_to(view(scene.end)), FreeStepQuery());
    EXPECT_EQ(step.share, 0);
    EXPECT_EQ(step.positions[3 * 3 + 2], 0);
    EXPECT_TRUE(
        detector.find((MeshView(scene.start, scene.triangles)).moving_to(view(scene.end)), FirstImpactQuery()).start);
}

TEST_P(ImpactQueries, first_impact_and_free_step_respect_the_min_distance) {
    const Falling scene;
    const MeshView mesh(scene.start, scene.triangles);
    EXPECT_EQ(detector.find(mesh.moving_to(view(scene.end)), FirstImpactQuery{{.min_distance = 0.5}}).toi, 0.25);
    EXPECT_EQ(detector.find(mesh.moving_to(view(scene.end)), FirstImpactQuery{{.min_distance_share = 0.25}}).toi,
              0.375);
    const FreeStep step = detector.find(mesh.moving_to(view(scene.end)), FreeStepQuery{{.min_distance = 0.5}});
    EXPECT_EQ(step.share, 0.25 * (1 - 0x1p-16));
}

INSTANTIATE_TEST_SUITE_P(, ImpactQueries, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& p) { return p.param == Backend::cpu ? "cpu" : "reference"; });

}  // namespace
}  // namespace crumple
