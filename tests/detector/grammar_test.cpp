// Tests that every query takes every kind of scene by the same call, and that unsupported combinations are rejected by
// one kind of error.

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <type_traits>
#include <vector>

#include "agreement/compare.h"
#include "error_of.h"
#include "soups.h"

namespace crumple {
namespace {

using test::error_of;
using test::random_soup;
using test::same_bytes;

std::string refusal(const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::invalid_argument) << error.what();
    return error.what();
}

/// World of two meshes as bodies.
struct TwoBodies {
    std::array<Shape, 2> shapes;
    std::array<Body, 2> bodies{Body{.shape = 0}, Body{.shape = 1}};
    TwoBodies(const MeshView& a, const MeshView& b) : shapes{Shape(a), Shape(b)} {}
    World world() const { return {shapes, bodies, {}}; }
};

class ScenesAndQueries : public testing::TestWithParam<Backend> {
   public:
    const test::Soup<double> a_ = random_soup<double>(60, 0.4), b_ = random_soup<double>(70, 0.4, 5);
    const std::vector<std::array<double, 3>> end_ = [this] {
        auto end = a_.vertices;
        for (std::size_t v = 0; v < end.size(); ++v) end[v][v % 3] += 0.1;
        return end;
    }();
    const VertexView end_view_ = rows_of_three(end_[0].data(), static_cast<std::int64_t>(end_.size()));
    Detector detector_{{.backend = GetParam()}}, other_{{.backend = GetParam()}};
};

INSTANTIATE_TEST_SUITE_P(, ScenesAndQueries, testing::Values(Backend::cpu, Backend::reference),
                         [](const auto& b) { return b.param == Backend::cpu ? "cpu" : "reference"; });

TEST_P(ScenesAndQueries, smaller_outputs_agree_with_the_pairs) {
    const MeshView a = a_.view(), b = b_.view();
    for (const Scene& scene : {Scene(a), Scene(a, b)}) {
        const Intersections all = other_.find(scene);
        ASSERT_GT(all.count, 20);
        EXPECT_TRUE(all.any);
        EXPECT_EQ(all.count, static_cast<std::int64_t>(all.pairs.size()));
        const auto with = [&](Output output) -> const Intersections& {
            return detector_.find(scene, {.output = output});
        };
        EXPECT_TRUE(with(Output::any).any);
        EXPECT_TRUE(with(Output::any).pairs.empty());
        const Intersections& by_world = with(Output::any_by_world);
        ASSERT_EQ(by_world.world_hit.size(), 1u);
        EXPECT_EQ(by_world.world_hit[0], 1);
        EXPECT_EQ(with(Output::count).count, all.count);
        EXPECT_TRUE(with(Output::count).pairs.empty());
        EXPECT_EQ(with(Output::body_pairs).bodies.size(), 1u);
        EXPECT_TRUE(detector_.any(scene));
        EXPECT_EQ(with(Output::pairs).pairs.size(), all.pairs.size());
        EXPECT_TRUE(same_bytes(detector_.find(scene).hit, all.hit, "hit flags"));
    }
}

TEST_P(ScenesAndQueries, two_meshes_give_the_results_of_two_bodies) {
    const MeshView a = a_.view(), b = b_.view();
    const TwoBodies bodies(a, b);
    EXPECT_TRUE(same_bytes(detector_.find({a, b}).pairs, other_.find(bodies.world()).pairs, "pairs of triangles"));
    const ProximityQuery near{.radius = 0.02};
    const Proximities of_meshes = detector_.find({a, b}, near), of_world = other_.find(bodies.world(), near);
    ASSERT_GT(of_meshes.count, 5);
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const ProximityList &found = of_meshes.lists[k], &expected = of_world.lists[k];
        EXPECT_TRUE(same_bytes(found.pairs, expected.pairs, "near pairs"));
        EXPECT_TRUE(same_bytes(found.bodies, expected.bodies, "near bodies"));
        EXPECT_TRUE(same_bytes(found.squared_distance, expected.squared_distance, "squared distances"));
    }
    const MeshView moving = a.moving_to(end_view_);
    const TwoBodies step(moving, b);
    const Impacts impacts = detector_.find({moving, b}, ImpactQuery()),
                  expected = other_.find(step.world(), ImpactQuery());
    ASSERT_GT(impacts.count, 5);
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        EXPECT_TRUE(same_bytes(impacts.lists[k].pairs, expected.lists[k].pairs, "impacts"));
        EXPECT_TRUE(same_bytes(impacts.lists[k].toi, expected.lists[k].toi, "toi"));
    }
    EXPECT_EQ(detector_.find({moving, b}, FirstImpactQuery()), expected.first);
    const Candidates candidates = detector_.find({a, b}, CandidateQuery{.inflation = 0.01}),
                     of_bodies = other_.find(bodies.world(), CandidateQuery{.inflation = 0.01});
    EXPECT_EQ(candidates.count, of_bodies.count);
    EXPECT_TRUE(candidates.any);
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        EXPECT_TRUE(same_bytes(candidates.lists[k].pairs, of_bodies.lists[k].pairs, "candidates"));
    const Distances distances = detector_.find({a, b}, DistanceQuery());
    EXPECT_EQ(distances.count, 1);
    EXPECT_TRUE(same_bytes(distances.squared_distance, other_.find(bodies.world(), DistanceQuery()).squared_distance,
                           "squared distances"));
    std::int64_t rows = 0;
    detector_.stream({a, b}, near, [&](const Proximities& block) { rows = block.count; });
    EXPECT_EQ(rows, of_meshes.count);
}

TEST_P(ScenesAndQueries, free_step_ends_before_the_first_impact) {
    const MeshView moving = a_.view().moving_to(end_view_);
    const Impacts all = other_.find(moving, ImpactQuery{.output = Output::first});
    ASSERT_TRUE(all.first.found);
    EXPECT_EQ(detector_.find(moving, FirstImpactQuery()), all.first);
    EXPECT_TRUE(detector_.any(moving, ImpactQuery()));
    const double share = detector_.find(moving, FreeStepQuery()).share;
    EXPECT_GT(share, 0);
    EXPECT_LT(share, all.first.toi);
    EXPECT_EQ(detector_.find(moving, FreeStepQuery{{.triangle_pairs = true}}).share, 0) << "some intersect already";
    EXPECT_EQ(detector_.find(a_.view().moving_to(a_.view().vertices), FirstImpactQuery{{.min_distance = 1}}).toi, 0);
}

TEST_P(ScenesAndQueries, unsupported_queries_are_rejected) {
    const MeshView a = a_.view();
    const TwoBodies bodies(a, a);
    const Part part = detector_.partition(a, {}, 2)[0];
    const auto of = [&](const Scene& scene, const auto& query) {
        return refusal(error_of([&] { detector_.find(scene, query); }));
    };
    EXPECT_EQ(of(a, DistanceQuery()), "distances need bodies: a world or two meshes");
    EXPECT_EQ(of(part, DistanceQuery()), "parts support only intersections, impacts, proximities and overlaps");
    EXPECT_EQ(of(part, CandidateQuery()), "parts support only intersections, impacts, proximities and overlaps");
    EXPECT_EQ(of(part, FreeStepQuery()), "parts support only intersections, impacts, proximities and overlaps");
    EXPECT_EQ(of(a, ImpactQuery()), "the vertices at the end are missing; a query about motion needs them");
    EXPECT_EQ(of(part, IntersectionQuery{.output = Output::count}), "output must be pairs or contacts for a part");
    for (const Scene& scene : {Scene(a), Scene(a, a), Scene(bodies.world())})
        EXPECT_EQ(of(scene, IntersectionQuery{.output = Output::first}),
                  "output must be any, any_by_world, body_pairs, count, pairs or contacts");
    EXPECT_EQ(of(a.moving_to(end_view_), ImpactQuery{.output = Output::contacts}),
              "output must be any, any_by_world, first or pairs");
    EXPECT_EQ(of(a, ProximityQuery{.output = Output::first}), "output must be any, any_by_world or pairs");
    EXPECT_EQ(of(a, IntersectionQuery{.filter = {.bodies = PairScope::within}}),
              "a filter of bodies needs a world of bodies");
    EXPECT_EQ(of({a, a}, IntersectionQuery{.filter = {.excluded_bodies = {{0, 1}}}}),
              "a filter of bodies needs a world of bodies");
    const auto ignore = [](const auto&) { FAIL(); };
    EXPECT_EQ(refusal(error_of([&] { detector_.stream(part, IntersectionQuery(), ignore); })),
              "parts are not supported in blocks; use find()");
    EXPECT_EQ(refusal(error_of([&] { detector_.partition(bodies.world(), {}, 2); })),
              "only one mesh or two meshes can be cut into parts");
    EXPECT_EQ(refusal(error_of([&] {
                  detector_.partition({a, a}, ProximityQuery(), 2);
              })),
              "only one mesh can be cut into parts for a query about features");
    EXPECT_EQ(detector_.find(a).count, other_.find(a).count) << "and goes on";
}

/// One scene of every kind, in host memory.
struct Scenes {
    test::Soup<double> soup = random_soup<double>(20, 0.4);
    MeshView mesh = soup.view();
    MeshView moving = mesh.moving_to(mesh.vertices);
    TwoBodies bodies{moving, moving};
    World world = bodies.world();
    Detector cpu{{.backend = Backend::cpu}};
    Part part = cpu.partition(mesh, {}, 1)[0];
    Part part_of_step = cpu.partition(moving, ImpactQuery(), 1)[0];
    Part part_of_proximities = cpu.partition(mesh, ProximityQuery(), 1)[0];
};

template <class Query>
Scene part_for(const Scenes& scenes) {
    if constexpr (std::is_base_of_v<ImpactQuery, Query>) return scenes.part_of_step;
    if constexpr (std::is_same_v<Query, ProximityQuery>) return scenes.part_of_proximities;
    return scenes.part;
}

template <class Query>
class SupportedQueries : public testing::Test {};
using Queries = testing::Types<IntersectionQuery, ImpactQuery, FirstImpactQuery, FreeStepQuery, ProximityQuery,
                               CandidateQuery, DistanceQuery, OverlapQuery>;
TYPED_TEST_SUITE(SupportedQueries, Queries, );

template <class Query>
Query query_about_any_triangles() {
    Query query;
    if constexpr (std::is_same_v<Query, OverlapQuery>) query.open = OpenSurfaces::skip;
    return query;
}

TYPED_TEST(SupportedQueries, supports_agrees_with_find) {
    const Scenes scenes;
    Detector detectors[] = {Detector({.backend = Backend::cpu}), Detector({.backend = Backend::reference})};
    for (Detector& detector : detectors)
        for (const Scene& scene : {Scene(scenes.moving), Scene(scenes.moving, scenes.moving), Scene(scenes.world),
                                   part_for<TypeParam>(scenes)}) {
            bool found = true;
            try {
                detector.find(scene, query_about_any_triangles<TypeParam>());
            } catch (const Error& error) {
                found = false;
                EXPECT_EQ(error.code, ErrorCode::invalid_argument);
            }
            EXPECT_EQ(detector.supports(scene, TypeParam()), found) << scene.source().index();
        }
    MeshView on_device = scenes.moving;
    on_device.memory = MemorySpace::cuda;
    EXPECT_FALSE(detectors[0].supports(on_device, TypeParam())) << "the cpu backend reads no device memory";
    EXPECT_FALSE(detectors[0].supports({on_device, on_device}, TypeParam()));
}

}  // namespace
}  // namespace crumple
