// Tests of errors of feature queries, the detector's state after them, and ownership of results.

#include <gtest/gtest.h>

#include <limits>
#include <stop_token>
#include <thread>

#include "detector/each_check_polls.h"
#include "error_of.h"
#include "features/compare_features.h"
#include "features/moving_soups.h"
#include "features/tested_detectors.h"
#include "memory_limit.h"

namespace crumple::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

class FeatureErrors : public testing::TestWithParam<Backend> {
   protected:
    Detector detector_{Options{.backend = GetParam(), .threads = 2}};
    const MovingSoup<> soup_ = moving_grid(3, 14, 10, 1);

    /// Returns the error of a call. Expects the call to empty the results that the detector holds, and not to affect
    /// later calls.
    template <class Call>
    Error refused(Call call) {
        const Impacts& impacts = detector_.find(soup_.view().moving_to(soup_.end_view()), ImpactQuery());
        const Proximities& nearby = detector_.find(soup_.view(), ProximityQuery{.radius = 1});
        EXPECT_GT(impacts.count, 0);
        EXPECT_GT(nearby.count, 0);
        const Error error = error_of(call);
        EXPECT_FALSE(impacts.any || impacts.count || impacts.first.found || !impacts.edges.empty() ||
                     !impacts.vertex_faces().pairs.empty() || !impacts.edge_edges().pairs.empty())
            << "holds an empty result";
        EXPECT_FALSE(nearby.any || nearby.count || !nearby.edges.empty() || !nearby.vertex_faces().pairs.empty() ||
                     !nearby.edge_edges().pairs.empty())
            << "holds an empty result";
        Detector fresh(detector_.options());
        EXPECT_TRUE(same_features(detector_.find(soup_.view().moving_to(soup_.end_view()), ImpactQuery()),
                                  fresh.find(soup_.view().moving_to(soup_.end_view()), ImpactQuery())));
        EXPECT_TRUE(same_features(detector_.find(soup_.view(), ProximityQuery{.radius = 1}),
                                  fresh.find(soup_.view(), ProximityQuery{.radius = 1})));
        return error;
    }
    Error refused(const MovingSoup<>& soup, const VertexView& end, const ImpactQuery& query = {}) {
        return refused([&] { detector_.find(soup.view().moving_to(end), query); });
    }
    Error refused(const World& world) {
        return refused([&] { detector_.find(world, ImpactQuery()); });
    }
};

TEST_P(FeatureErrors, end_positions_of_another_number_of_vertices_are_rejected) {
    VertexView end = soup_.end_view();
    end.rows = 13;
    EXPECT_EQ(refused(soup_, end).code, ErrorCode::invalid_argument);
    end.rows = 15;
    EXPECT_EQ(refused(soup_, end).code, ErrorCode::invalid_argument);
    end.rows = 0;
    EXPECT_EQ(refused(soup_, end).code, ErrorCode::invalid_argument);
}
TEST_P(FeatureErrors, end_positions_may_be_float32_with_a_float64_start) {
    const auto floats = rounded<float>(soup_);
    const auto doubles = rounded<double>(floats);
    const Impacts expected = detector_.find(soup_.view().moving_to(doubles.end_view()), ImpactQuery());
    EXPECT_TRUE(same_features(detector_.find(soup_.view().moving_to(floats.end_view()), ImpactQuery()), expected));
}
TEST_P(FeatureErrors, missing_end_positions_are_rejected) {
    EXPECT_STREQ(refused(soup_, {}).what(), "the vertices at the end are missing; a query about motion needs them");
    VertexView end = soup_.end_view();
    end.data = nullptr;
    EXPECT_EQ(refused(soup_, end).code, ErrorCode::invalid_argument) << "so many vertices, but no data";
}
TEST_P(FeatureErrors, error_names_the_vertex_that_is_not_finite_at_the_end) {
    for (const double value : {nan, inf, -inf}) {
        auto soup = soup_;
        soup.end[11][2] = value;
        const Error error = refused(soup, soup.end_view());
        EXPECT_EQ(error.code, ErrorCode::not_finite);
        EXPECT_EQ(error.element, Element::vertex);
        EXPECT_EQ(error.index, 11);
        EXPECT_STREQ(error.what(), "at the end: vertex 11 is not finite");
        // If the start is not finite either, the error names the start.
        soup.start[12][0] = value;
        EXPECT_STREQ(refused(soup, soup.end_view()).what(), "vertex 12 is not finite");
        EXPECT_STREQ(refused([&] { detector_.find(soup.view(), ProximityQuery()); }).what(), "vertex 12 is not finite");
    }
}
TEST_P(FeatureErrors, error_names_the_triangle_with_an_index_out_of_range) {
    auto soup = soup_;
    soup.triangles[4][1] = 14;
    EXPECT_STREQ(refused(soup, soup.end_view()).what(), "triangle 4 names vertex 14 of 14");
    EXPECT_STREQ(refused([&] { detector_.find(soup.view(), ProximityQuery()); }).what(),
                 "triangle 4 names vertex 14 of 14");
}
TEST_P(FeatureErrors, invalid_distances_are_rejected) {
    const VertexView end = soup_.end_view();
    for (const double wrong : {nan, inf, -1.0, -std::numeric_limits<double>::denorm_min()}) {
        EXPECT_EQ(refused(soup_, end, {.min_distance = wrong}).element, Element::option);
        EXPECT_EQ(refused(soup_, end, {.min_distance_share = wrong}).element, Element::option);
        EXPECT_EQ(refused([&] { detector_.find(soup_.view(), ProximityQuery{.radius = wrong}); }).element,
                  Element::option);
    }
    EXPECT_EQ(refused(soup_, end, {.min_distance_share = 1}).code, ErrorCode::invalid_argument);
    EXPECT_TRUE(same_features(Impacts(detector_.find(soup_.view().moving_to(end), ImpactQuery{.min_distance = -0.0})),
                              detector_.find(soup_.view().moving_to(end), ImpactQuery())));
}
TEST_P(FeatureErrors, mesh_in_the_wrong_memory_is_rejected) {
    MeshView mesh = soup_.view();
    mesh.memory = MemorySpace::cuda;
    EXPECT_EQ(refused([&] { detector_.find(mesh.moving_to(soup_.end_view()), ImpactQuery()); }).code,
              ErrorCode::invalid_argument);
    EXPECT_EQ(refused([&] { detector_.find(mesh, ProximityQuery()); }).code, ErrorCode::invalid_argument);
}
TEST_P(FeatureErrors, worlds_with_invalid_poses_or_end_positions_are_rejected) {
    std::vector<Shape> shapes{Shape(soup_.view()), Shape(soup_.view())};
    shapes[1].end = soup_.end_view();
    const std::vector<Body> bodies{{.shape = 0, .self = true}, {.shape = 1, .self = true}};
    const std::vector<Pose> good(2);
    std::vector<Pose> bad(3);
    EXPECT_STREQ(refused({shapes, bodies, good, bad}).what(), "there are 3 poses for 2 bodies");
    bad.pop_back();
    bad[1].rows[7] = nan;
    Error error = refused({shapes, bodies, good, bad});
    EXPECT_STREQ(error.what(), "body 1: its pose is not finite");
    EXPECT_EQ(error.element, Element::body);
    EXPECT_EQ(error.index, 1);
    bad[1].rows[7] = 0;
    bad[1].rows[0] = std::numeric_limits<double>::max();
    error = refused({shapes, bodies, {}, bad});
    EXPECT_EQ(error.code, ErrorCode::not_finite);
    EXPECT_NE(std::string(error.what()).find("is posed to infinity at the end"), std::string::npos) << error.what();
    --shapes[1].end.rows;
    error = refused({shapes, bodies, {}, {}});
    EXPECT_EQ(error.element, Element::shape);
    EXPECT_EQ(error.index, 1);
    shapes[1].end = {nullptr, 14, 24, 8, ScalarType::float64};
    EXPECT_EQ(refused({shapes, bodies, {}, {}}).element, Element::shape) << "so many vertices, but no data";
}
TEST_P(FeatureErrors, excluded_bodies_that_do_not_exist_are_rejected) {
    ImpactQuery query;
    query.filter.excluded_bodies = {{0, 1}};
    EXPECT_EQ(refused(soup_, soup_.end_view(), query).element, Element::body);
}
TEST_P(FeatureErrors, filter_between_groups_needs_groups) {
    PairFilter filter;
    filter.groups = PairScope::between;
    const char* const message =
        "filter.groups = between needs groups, and the mesh has none: nothing lies between different groups";
    EXPECT_STREQ(refused(soup_, soup_.end_view(), {.filter = filter}).what(), message);
    EXPECT_STREQ(refused([&] { detector_.find(soup_.view(), ProximityQuery{.filter = filter}); }).what(), message);
    EXPECT_STREQ(refused([&] { detector_.find(soup_.view(), CandidateQuery{.filter = filter}); }).what(), message);
    EXPECT_STREQ(refused([&] {
                     detector_.stream(soup_.view(), ProximityQuery{.filter = filter}, [](const Proximities&) {});
                 }).what(),
                 message);
    if (GetParam() == Backend::cuda) return;  // the cuda backend has no parts
    const auto parts = detector_.partition(soup_.view().moving_to(soup_.end_view()), ImpactQuery(), 1);
    EXPECT_STREQ(refused([&] { detector_.find(parts[0], ImpactQuery{.filter = filter}); }).what(), message);
    const MovingSoup<> none;
    EXPECT_FALSE(detector_.find(none.view(), ProximityQuery{.filter = filter}).any)
        << "there is nothing to have groups";
}
/// All rows of the view refer to the same vertex in memory.
TEST_P(FeatureErrors, too_many_moving_vertices_are_rejected) {
    MeshView mesh = soup_.view();
    mesh.vertices.rows = (std::int64_t{1} << 30) + 1;
    mesh.vertices.row_stride = 0;
    EXPECT_STREQ(refused([&] { detector_.find(mesh.moving_to(mesh.vertices), ImpactQuery()); }).what(),
                 "a moving scene can have at most 1073741824 vertices");
}
TEST_P(FeatureErrors, stopped_calls_report_cancellation) {
    std::stop_source stop;
    stop.request_stop();
    const auto code = [&](auto call) { return refused(call).code; };
    const auto token = stop.get_token();
    EXPECT_EQ(code([&] { detector_.find(soup_.view().moving_to(soup_.end_view()), ImpactQuery(), token); }),
              ErrorCode::cancelled);
    EXPECT_EQ(code([&] { detector_.find(soup_.view(), ProximityQuery(), token); }), ErrorCode::cancelled);
    EXPECT_EQ(code([&] { detector_.any(soup_.view().moving_to(soup_.end_view()), ImpactQuery(), token); }),
              ErrorCode::cancelled);
    const std::vector<Shape> shapes{Shape(soup_.view())};
    const std::vector<Body> bodies(2, Body{.self = true});
    EXPECT_EQ(code([&] { detector_.find(World{shapes, bodies, {}}, ProximityQuery(), token); }), ErrorCode::cancelled);
}

INSTANTIATE_TEST_SUITE_P(, FeatureErrors, testing::ValuesIn(tested_backends), name_of_backend);

/// All triangles are in one leaf. Its tests take about a second, since no floating-point filter can decide such large
/// numbers. If the call polled only between leaves and chunks, it would poll about three times.
TEST(FeatureCalls, stop_requests_are_polled_between_exact_decisions) {
    constexpr double unit = 0x1p600;
    MovingSoup<> soup = moving_grid(6, 60, 40, 2);
    for (auto* vertices : {&soup.start, &soup.end})
        for (auto& p : *vertices)
            for (double& x : p) x *= unit;
    const test::EachCheckPolls each_check_polls;
    Detector detector({.backend = tested_backend, .threads = 1});
    int polls = 0;
    detector.set_poll([&] { ++polls; });
    const Impacts& found = detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.min_distance = unit});
    EXPECT_GT(found.statistics.rational_tests, 10);
    EXPECT_GE(polls, found.statistics.rational_tests);
    std::stop_source stop;
    detector.set_poll([&] { stop.request_stop(); });
    const auto call = [&] {
        detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.min_distance = unit}, stop.get_token());
    };
    EXPECT_EQ(error_of(call).code, ErrorCode::cancelled);
}

/// Two flat sheets that slide through each other in one plane touch everywhere at the start. The first of these pairs
/// ends the search for the first impact, and is the first impact of the whole list.
TEST(FeatureCalls, first_of_many_impacts_at_the_start_is_found_without_deciding_all) {
    constexpr std::int32_t n = 8;
    std::vector<std::array<double, 3>> start, end;
    std::vector<std::array<std::int32_t, 3>> triangles;
    for (std::int32_t sheet = 0; sheet < 2; ++sheet) {
        const auto first = static_cast<std::int32_t>(start.size());
        for (std::int32_t i = 0; i <= n; ++i)
            for (std::int32_t j = 0; j <= n; ++j) {
                start.push_back({i + 0.37 * sheet, j + 0.21 * sheet, 0});
                end.push_back({start.back()[0] + 3.3 * sheet, start.back()[1] - 2.1 * sheet, 0});
            }
        for (std::int32_t i = 0; i < n; ++i)
            for (std::int32_t j = 0; j < n; ++j) {
                const std::int32_t a = first + i * (n + 1) + j;
                triangles.push_back({a, a + n + 1, a + n + 2});
                triangles.push_back({a, a + n + 2, a + 1});
            }
    }
    const MeshView mesh(start, triangles), moved(end, triangles);
    for (const int threads : {1, 2, 7}) {
        Detector detector({.backend = Backend::cpu, .threads = threads});
        const Impacts& all = detector.find(mesh.moving_to(moved.vertices), ImpactQuery());
        const FirstImpact expected = all.first;
        const std::int64_t decided = all.statistics.double_tests, exact = all.statistics.exact_tests;
        ASSERT_TRUE(expected.found && expected.toi == 0 && expected.start);
        for (int again = 0; again < 5; ++again) {
            const Impacts& first = detector.find(mesh.moving_to(moved.vertices), ImpactQuery{.output = Output::first});
            EXPECT_TRUE(first.first.found && first.first.toi == 0 && first.first.start);
            EXPECT_EQ(first.first.kind, expected.kind);
            EXPECT_EQ(first.first.pair, expected.pair);
            EXPECT_EQ(first.statistics.double_tests, decided);
            EXPECT_LT(first.statistics.exact_tests, exact / 4) << "most pairs cannot be the first, and are not decided";
        }
        EXPECT_EQ(detector.find(mesh.moving_to(moved.vertices), FirstImpactQuery()).toi, 0);
        EXPECT_EQ(detector.find(mesh.moving_to(moved.vertices), FreeStepQuery()).share, 0);
    }
}

TEST(FeatureCalls, swap_result_moves_the_result_without_copying) {
    const MovingSoup<> soup = moving_grid(4, 30, 24, 3);
    Detector detector({.backend = tested_backend, .threads = 2}), fresh({.backend = tested_backend});
    const Impacts& impacts = detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.index = true});
    const Proximities& nearby = detector.find(soup.view(), ProximityQuery{.radius = 1, .index = true});
    const Pair* const storage = impacts.vertex_faces().pairs.data();
    const Pair* const storage_of_near = nearby.vertex_faces().pairs.data();
    Impacts taken;
    Proximities near;
    detector.swap_result(taken);
    detector.swap_result(near);
    EXPECT_EQ(taken.vertex_faces().pairs.data(), storage) << "nothing is copied";
    EXPECT_EQ(near.vertex_faces().pairs.data(), storage_of_near) << "nothing is copied";
    EXPECT_FALSE(impacts.any || impacts.first.found || impacts.count || !impacts.edge_edges().pairs.empty());
    EXPECT_FALSE(nearby.any || nearby.count || !nearby.edge_edges().pairs.empty());
    Impacts spare;
    detector.find(soup.view().moving_to(soup.view().vertices), ImpactQuery());
    detector.swap_result(spare);
    detector.find(soup.view(), ProximityQuery());
    const Impacts& expected = fresh.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.index = true});
    EXPECT_TRUE(same_features(taken, expected));
    EXPECT_TRUE(same_features(near, fresh.find(soup.view(), ProximityQuery{.radius = 1, .index = true})));
    detector.swap_result(taken);  // its storage is reused by the next call
    EXPECT_EQ(taken.count, 0);
    EXPECT_TRUE(
        same_features(detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.index = true}), expected));
}

TEST(FeatureCalls, results_do_not_depend_on_earlier_calls) {
    const auto soups = [] {
        std::vector<MovingSoup<>> all{moving_grid(3, 20, 20, 4), in_general(60, 0.3, 0.2, 5), {}};
        all.push_back(all[1]);
        for (auto& p : all.back().end) p[0] += 0.01;  // the next frame of the same triangles
        all.push_back(all[1]);
        std::swap(all.back().triangles[3], all.back().triangles[40]);  // other triangles of the same number
        return all;
    }();
    Detector warm({.backend = tested_backend, .threads = 2, .leaf_size = 8});
    for (int round = 0; round < 2; ++round)
        for (std::size_t s = 0; s < soups.size(); ++s) {
            SCOPED_TRACE(s);
            const MovingSoup<>& soup = soups[s];
            Detector fresh({.backend = tested_backend, .threads = 2, .leaf_size = 8});
            const ImpactQuery motion{.weld = s % 2 == 0, .index = true};
            ASSERT_TRUE(same_features(warm.find(soup.view().moving_to(soup.end_view()), motion),
                                      fresh.find(soup.view().moving_to(soup.end_view()), motion)));
            ASSERT_TRUE(same_features(warm.find(soup.view(), ProximityQuery{.radius = 0.1}),
                                      fresh.find(soup.view(), ProximityQuery{.radius = 0.1})));
            const ProximityQuery filtered{
                .radius = 0.1, .rings = 1 + round, .rest = soup.end_view(), .rest_radius = 0.05};
            ASSERT_TRUE(same_features(warm.find(soup.view(), filtered), fresh.find(soup.view(), filtered)));
            ASSERT_TRUE(same_result(warm.find(soup.view()), fresh.find(soup.view())));
            std::vector<Shape> shapes{Shape(soup.view())};
            shapes[0].end = soup.end_view();
            const std::vector<Body> bodies{
                {.world = 0, .self = true}, {.world = 1, .self = true}, {.world = 1, .self = true}};
            const ImpactQuery in_worlds{.weld = motion.weld};
            ASSERT_TRUE(same_features(warm.find(World{shapes, bodies, {}}, in_worlds),
                                      fresh.find(World{shapes, bodies, {}}, in_worlds)));
        }
}

class FeatureMemory : public testing::TestWithParam<int> {};

TEST_P(FeatureMemory, limited_call_gives_same_result_or_names_larger_limit) {
    const MovingSoup<> soup = in_general(played ? 400 : 1500, played ? 0.14 : 0.07, played ? 0.12 : 0.06, 6);
    const Options options{.backend = tested_backend, .threads = GetParam(), .leaf_size = 40};
    const std::vector<double> radii(soup.start.size(), 0.005);
    const ProximityQuery one{.radius = 0.01},
        filtered{.radii = radii, .rings = 3, .rest = soup.end_view(), .rest_radius = 0.01};
    const auto queries = {0, 1, 2};
    for (const int query : queries) {
        const auto find = [&](Detector& detector) -> std::int64_t {
            return query ? detector.find(soup.view(), query == 1 ? one : filtered).statistics.peak_memory_bytes
                         : detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery())
                               .statistics.peak_memory_bytes;
        };
        Detector free(options);
        const std::int64_t peak = find(free);
        Impacts impacts;
        Proximities nearby;
        free.swap_result(impacts);
        free.swap_result(nearby);
        const auto same = [&](Detector& detector) {
            Impacts found;
            Proximities found_near;
            detector.swap_result(found);
            detector.swap_result(found_near);
            return query ? same_features(found_near, nearby) : same_features(found, impacts);
        };
        bool refused = false;
        for (std::int64_t limit = peak; limit > 10'000; limit = limit * 3 / 5) {
            SCOPED_TRACE(testing::Message() << "limit " << limit << ", question " << query);
            Options tight = options;
            tight.memory_limit = limit;
            Detector limited(tight);
            try {
                EXPECT_LE(find(limited), limit);
                EXPECT_TRUE(same(limited));
            } catch (const Error& error) {
                refused = true;
                ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
                EXPECT_GT(error.bytes_needed, limit);
                tight.memory_limit = sufficient_limit(tight, find);
                for (int again = 0; again < (played ? 1 : 5); ++again) {
                    Detector enough(tight);
                    EXPECT_LE(find(enough), tight.memory_limit);
                    EXPECT_TRUE(same(enough));
                }
                EXPECT_NO_THROW(limited.find(MeshView(), ProximityQuery())) << "usable still";
            }
        }
        EXPECT_TRUE(refused) << "no limit was too small";
    }
}
INSTANTIATE_TEST_SUITE_P(Threads, FeatureMemory, played ? testing::ValuesIn({1}) : testing::ValuesIn({1, 2, 5}));

}  // namespace
}  // namespace crumple::test
