// Compares impacts and proximities on many ranks with those of a single detector, byte by byte.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "crumple/crumple.h"
#include "distributed/feature_rows.h"
#include "distributed/last_frame.h"
#include "distributed/rank_detector.h"
#include "distributed/rank_failures.h"
#include "distributed/thread_ranks.h"
#include "rounds.h"
#include "tested_backend.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

DistributedOptions single_thread(int parts = 0) {
    DistributedOptions options;
    options.detector.backend = tested_backend;
    options.detector.threads = 1;
    options.parts = parts;
    return options;
}

testing::AssertionResult same_impacts(const Step& step, Distribution how, int ranks, const ImpactQuery& query,
                                      const DistributedOptions& options = single_thread()) {
    Detector one({.backend = Backend::cpu});
    const Impacts expected = one.find(step.start.view().moving_to(step.end_view()), query);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const int rank = transport.rank();
        const MeshPiece start(step.start, how, rank, ranks), end(step.end, how, rank, ranks);
        const VertexView end_view = end.local().mesh.vertices;
        RankDetector detector(transport, options);
        const DistributedImpacts& found = detector.find(start.local().moving_to(end_view), query);
        verdicts.add(rank, rows_are(found, start.triangle_ids, expected, step.start));
        if (!(found.first == expected.first)) verdicts.add(rank, testing::AssertionFailure() << "first impact");
        ImpactQuery smaller = query;
        smaller.output = Output::any;
        if (detector.find(start.local().moving_to(end_view), smaller).any != expected.any)
            verdicts.add(rank, testing::AssertionFailure() << "any");
        smaller.output = Output::first;
        if (!(detector.find(start.local().moving_to(end_view), smaller).first == expected.first))
            verdicts.add(rank, testing::AssertionFailure() << "earliest");
    });
    return verdicts.all();
}

testing::AssertionResult same_near(const WholeMesh& mesh, Distribution how, int ranks, const ProximityQuery& query,
                                   const DistributedOptions& options = single_thread()) {
    Detector one({.backend = Backend::cpu});
    const Proximities expected = one.find(mesh.view(), query);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const int rank = transport.rank();
        const MeshPiece piece(mesh, how, rank, ranks);
        RankDetector detector(transport, options);
        verdicts.add(rank, rows_are(detector.find(piece.local(), query), piece.triangle_ids, expected, mesh));
        ProximityQuery smaller = query;
        smaller.output = Output::any;
        if (detector.find(piece.local(), smaller).any != expected.any)
            verdicts.add(rank, testing::AssertionFailure() << "any");
    });
    return verdicts.all();
}

TEST(RankFeatures, impacts_match_a_single_detector) {
    const Step sheet(WholeMesh(wavy_sheet<float>(12))), soup(WholeMesh(random_soup<double>(150, 0.3)));
    for (const int ranks : {1, 3})
        for (const Distribution how : every_distribution)
            for (const Step* step : {&sheet, &soup})
                ASSERT_TRUE(same_impacts(*step, how, ranks, {}))
                    << ranks << " ranks, distribution " << static_cast<int>(how);
}

TEST(RankFeatures, proximities_match_a_single_detector) {
    const WholeMesh sheet(wavy_sheet<double>(12)), soup(random_soup<float>(150, 0.3));
    for (const int ranks : {1, 3})
        for (const Distribution how : every_distribution)
            for (const WholeMesh* mesh : {&sheet, &soup})
                ASSERT_TRUE(same_near(*mesh, how, ranks, {.radius = 0.05, .closest = true}))
                    << ranks << " ranks, distribution " << static_cast<int>(how);
}

TEST(RankFeatures, hard_soups_match_a_single_detector) {
    if (played && !thorough()) GTEST_SKIP() << "only with CRUMPLE_ROUNDS on an emulated device";
    std::size_t number = 0;
    for (const NamedMove<double>& soup : moving_soups<double>()) {
        const Step step(soup.soup);
        ImpactQuery motion;
        motion.weld = number % 2 == 0;
        motion.min_distance = number % 3 == 0 ? 0.25 : 0;
        motion.min_distance_share = number % 4 == 0 ? 0.1 : 0;
        motion.approaching_only = number % 6 >= 3;
        if (!step.start.groups.empty())
            motion.filter.groups = number % 5 == 1   ? PairScope::between
                                   : number % 5 == 2 ? PairScope::within
                                                     : PairScope::both;
        const Distribution how = every_distribution[number % 2 == 0 ? 2 : 1];
        ASSERT_TRUE(same_impacts(step, how, 3, motion)) << soup.name;
        ProximityQuery near{
            .radius = 0.5, .strict = number % 2 == 1, .closest = number % 3 == 1, .weld = number % 3 == 0};
        near.filter.groups = motion.filter.groups;
        ASSERT_TRUE(same_near(step.start, how, 3, near)) << soup.name;
        ++number;
    }
}

TEST(RankFeatures, scenes_match_a_single_detector) {
    if (played && !thorough()) GTEST_SKIP() << "only with CRUMPLE_ROUNDS on an emulated device";
    for (const scenes::Description& scene : scenes::descriptions()) {
        const WholeMesh mesh = last_frame(scene, 600);
        ASSERT_TRUE(same_impacts(Step(mesh, 0.01), Distribution::blocks, 3, {})) << scene.name;
        ASSERT_TRUE(same_near(mesh, Distribution::random, 3, {.radius = 0.01})) << scene.name;
    }
}

TEST(RankFeatures, changing_queries_match_a_single_detector_in_a_moving_scene) {
    WholeMesh mesh(wavy_sheet<float>(14));
    constexpr int ranks = 3, frames = 8;
    std::vector<Step> steps;
    for (int f = 0; f < frames; ++f) {
        steps.emplace_back(mesh, 0.02 * (f % 3 + 1));
        mesh.vertices = steps.back().end.vertices;
    }
    RankFailures verdicts;
    int moved = 0;
    run_ranks(ranks, [&](Transport& transport) {
        const int rank = transport.rank();
        RankDetector detector(transport, single_thread(5));
        detector.set_clock([] { return 0.0; });
        Detector one({.backend = Backend::cpu, .threads = 1});
        for (int f = 0; f < frames; ++f) {
            const Step& step = steps[static_cast<std::size_t>(f)];
            const MeshPiece start(step.start, Distribution::random, rank, ranks),
                end(step.end, Distribution::random, rank, ranks);
            if (f == 4) {
                const ProximityQuery query{.radius = 0.03};
                verdicts.add(rank, rows_are(detector.find(start.local(), query), start.triangle_ids,
                                            one.find(step.start.view(), query), step.start));
                verdicts.add(rank, test::rows_are(detector.find(start.local()), start.triangle_ids,
                                                  one.find(step.start.view())));
            }
            const ImpactQuery query{.min_distance = f < 6 ? 0.0 : 0.01};
            const DistributedImpacts& found = detector.find(start.local().moving_to(end.local().mesh.vertices), query);
            verdicts.add(rank, rows_are(found, start.triangle_ids,
                                        one.find(step.start.view().moving_to(step.end_view()), query), step.start));
            if (rank == 0) moved += found.statistics.moved;
        }
    });
    EXPECT_TRUE(verdicts.all());
    EXPECT_GE(moved, 1);
}

TEST(RankFeatures, vertex_that_a_rank_lists_twice_gives_each_pair_once) {
    Soup<float> soup;
    soup.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {1, 1, 1}, {0, 2, 1}};
    soup.triangles = {{0, 0, 1}, {2, 3, 4}};
    const WholeMesh mesh(soup);
    Soup<float> listed = soup;
    listed.vertices.insert(listed.vertices.begin(), soup.vertices[0]);
    listed.triangles = {{0, 1, 2}, {3, 4, 5}};
    const std::vector<std::int64_t> ids{0, 0, 1, 2, 3, 4};
    Detector one({.backend = Backend::cpu});
    const ProximityQuery query{.radius = 10};
    const Proximities& expected = one.find(mesh.view(), query);
    ASSERT_GT(expected.count, 0);
    RankFailures verdicts;
    run_ranks(1, [&](Transport& transport) {
        RankDetector detector(transport, single_thread());
        verdicts.add(0, rows_are(detector.find(LocalMesh{listed.view(), {}, ids}, query), {0, 1}, expected, mesh));
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(RankFeatures, few_or_no_triangles_match_a_single_detector) {
    for (const int triangles : {0, 1, 2}) {
        const Step step(WholeMesh(random_soup<float>(triangles, 0.9)), 0.4);
        ASSERT_TRUE(same_impacts(step, Distribution::round_robin, 3, {}));
        ASSERT_TRUE(same_near(step.start, Distribution::round_robin, 3, {.radius = 1}));
    }
}

}  // namespace
}  // namespace crumple::test
