// Compares ranks with a single detector, byte by byte, for several numbers of ranks and distributions of triangles.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stop_token>
#include <vector>

#include "agreement/hard_soups.h"
#include "crumple/crumple.h"
#include "distributed/last_frame.h"
#include "distributed/rank_detector.h"
#include "distributed/rank_failures.h"
#include "distributed/rank_meshes.h"
#include "distributed/thread_ranks.h"
#include "error_of.h"
#include "rounds.h"
#include "tested_backend.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

// Options of the ranks. The backend is the tested one (tested_backend.h).

DistributedOptions one_thread(int parts = 0, std::int64_t batch_bytes = std::int64_t{1} << 26) {
    DistributedOptions options;
    options.detector.backend = tested_backend;
    options.detector.threads = 1;
    options.parts = parts;
    options.batch_bytes = batch_bytes;
    return options;
}

Intersections result_of_one(const WholeMesh& mesh, const IntersectionQuery& query = {}) {
    Detector one({.backend = Backend::cpu});
    return one.find(mesh.view(), query);
}

testing::AssertionResult same_as_one(const WholeMesh& mesh, Distribution how, int ranks,
                                     const IntersectionQuery& query = {},
                                     const DistributedOptions& options = one_thread()) {
    const Intersections expected = result_of_one(mesh, query);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const int rank = transport.rank();
        const MeshPiece piece(mesh, how, rank, ranks);
        RankDetector detector(transport, options);
        verdicts.add(rank, rows_are(detector.find(piece.local(), query), piece.triangle_ids, expected));
        IntersectionQuery smaller = query;
        smaller.output = Output::any;
        const bool any = detector.find(piece.local(), smaller).any;
        const std::int64_t count = count_pairs(detector, piece.local(), query);
        if (any != (count > 0) || count != static_cast<std::int64_t>(expected.pairs.size()))
            verdicts.add(rank, testing::AssertionFailure() << "any " << any << ", count " << count);
    });
    return verdicts.all();
}

TEST(Ranks, every_distribution_matches_a_single_detector) {
    const WholeMesh sheet(wavy_sheet<float>(16)), soup(random_soup<double>(300, 0.2));
    for (const int ranks : {1, 2, 3, 5})
        for (const Distribution how : every_distribution)
            for (const WholeMesh* mesh : {&sheet, &soup})
                for (const bool contacts : {false, true})
                    ASSERT_TRUE(same_as_one(*mesh, how, ranks, {.output = contacts ? Output::contacts : Output::pairs}))
                        << ranks << " ranks, distribution " << static_cast<int>(how) << ", contacts " << contacts;
}

TEST(Ranks, hard_soups_match_a_single_detector) {
    if (played && !thorough()) GTEST_SKIP() << "only with CRUMPLE_ROUNDS on an emulated device";
    std::size_t number = 0;
    for (const NamedMesh& soup : hard_soups()) {
        IntersectionQuery query;
        query.output = number % 2 == 0 ? Output::contacts : Output::pairs;
        query.weld = number % 3 == 0;
        query.neighbours = number % 5 == 0 ? Neighbours::skip : Neighbours::geometric;
        query.kind = number % 7 == 0 ? IntersectionKind::proper : IntersectionKind::all;
        const std::array scopes{PairScope::both, PairScope::between, PairScope::within};
        query.filter.groups = scopes[number % 3];
        const std::vector<GroupPair> excluded{{0, 1}};
        if (number % 4 == 3) query.filter.excluded_groups = excluded;
        ASSERT_TRUE(
            same_as_one(WholeMesh(soup.mesh), every_distribution[number % 4], 2 + static_cast<int>(number % 3), query))
            << soup.name;
        ++number;
    }
}

TEST(Ranks, scenes_match_a_single_detector) {
    if (played && !thorough()) GTEST_SKIP() << "only with CRUMPLE_ROUNDS on an emulated device";
    std::size_t number = 0;
    for (const scenes::Description& scene : scenes::descriptions()) {
        const WholeMesh mesh = last_frame(scene, 1500);
        EXPECT_TRUE(!scene.simulated || !result_of_one(mesh).pairs.empty()) << scene.name;
        ASSERT_TRUE(same_as_one(mesh, every_distribution[number++ % 4], 3, {.output = Output::contacts})) << scene.name;
    }
}

TEST(Ranks, many_ranks_and_parts_match_a_single_detector) {
    if (played && !thorough()) GTEST_SKIP() << "only with CRUMPLE_ROUNDS on an emulated device";
    const WholeMesh sheet(wavy_sheet<float>(40));
    for (const Distribution how : {Distribution::blocks, Distribution::random})
        ASSERT_TRUE(same_as_one(sheet, how, 64, {.output = Output::contacts}));
    ASSERT_TRUE(same_as_one(sheet, Distribution::round_robin, 3, {}, one_thread(200)));
}

TEST(Ranks, small_message_batches_match_a_single_detector) {
    const WholeMesh sheet(wavy_sheet<double>(30));
    for (const Distribution how : every_distribution)
        ASSERT_TRUE(same_as_one(sheet, how, 4, {.output = Output::contacts}, one_thread(0, 1024)));
}

TEST(Ranks, few_or_no_triangles_match_a_single_detector) {
    const WholeMesh nothing(Soup<float>{}), one(random_soup<float>(1, 0.5)), two(random_soup<float>(2, 2.0));
    for (const int ranks : {1, 2, 5})
        for (const WholeMesh* mesh : {&nothing, &one, &two})
            for (const int parts : {0, 7})
                ASSERT_TRUE(same_as_one(*mesh, Distribution::round_robin, ranks, {.output = Output::contacts},
                                        one_thread(parts)));
    // All triangles coincide, and so do all centres.
    Soup<float> stack;
    stack.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (int i = 0; i < 40; ++i) stack.triangles.push_back({0, 1, 2});
    ASSERT_TRUE(same_as_one(WholeMesh(stack), Distribution::round_robin, 3, {}, one_thread(5)));
}

TEST(Ranks, ids_may_be_omitted_if_ranks_share_no_vertices) {
    const Soup<float> soup = random_soup<float>(300, 0.3);
    const Intersections expected = result_of_one(WholeMesh(soup));
    RankFailures verdicts;
    run_ranks(3, [&](Transport& transport) {
        const int rank = transport.rank();
        const std::int32_t begin = 100 * rank;
        Soup<float> mine;
        std::vector<std::int64_t> ids;
        for (std::int32_t t = begin; t < begin + 100; ++t) {
            ids.push_back(t);
            for (int k = 0; k < 3; ++k) mine.vertices.push_back(soup.vertices[static_cast<std::size_t>(3 * t + k)]);
            mine.triangles.push_back({3 * (t - begin), 3 * (t - begin) + 1, 3 * (t - begin) + 2});
        }
        RankDetector detector(transport, one_thread());
        verdicts.add(rank, rows_are(detector.find(LocalMesh{mine.view(), {}, {}}), ids, expected));
    });
    EXPECT_TRUE(verdicts.all());
}

/// Sets the coordinates at a time: the sheet `from` moves along x and waves.
void move(WholeMesh& mesh, const WholeMesh& from, double time) {
    std::visit(
        [&](auto& xyz) {
            using Scalar = typename std::remove_cvref_t<decltype(xyz)>::value_type;
            const auto& start = std::get<std::remove_cvref_t<decltype(xyz)>>(from.vertices);
            for (std::size_t i = 0; i < xyz.size(); i += 3) {
                const auto x = static_cast<double>(start[i]), y = static_cast<double>(start[i + 1]),
                           z = static_cast<double>(start[i + 2]);
                xyz[i] = static_cast<Scalar>(x + 0.5 * time + 0.1 * std::sin(9 * y + 5 * time));
                xyz[i + 1] = static_cast<Scalar>(y + 0.1 * std::cos(7 * x + 3 * time));
                xyz[i + 2] = static_cast<Scalar>(z + 0.2 * std::sin(4 * x + 6 * y + time));
            }
        },
        mesh.vertices);
}

TEST(Ranks, moving_scene_matches_a_single_detector) {
    const WholeMesh start(wavy_sheet<float>(24));
    constexpr int ranks = 3, frames = 50;
    std::vector<WholeMesh> meshes(frames, start);
    std::vector<Intersections> expected;
    for (int f = 0; f < frames; ++f) {
        move(meshes[static_cast<std::size_t>(f)], start, 0.1 * f);
        expected.push_back(result_of_one(meshes[static_cast<std::size_t>(f)]));
    }
    for (const Distribution how : {Distribution::blocks, Distribution::random}) {
        RankFailures verdicts;
        int moved = 0;
        run_ranks(ranks, [&](Transport& transport) {
            const int rank = transport.rank();
            WholeMesh now = start;
            MeshPiece piece(now, how, rank, ranks);
            RankDetector detector(transport, one_thread(6));
            detector.set_clock([] { return 0.0; });  // no part moves to another rank
            for (std::size_t f = 0; f < frames; ++f) {
                now.vertices = meshes[f].vertices;
                piece.follow();
                const DistributedIntersections& found = detector.find(piece.local());
                verdicts.add(rank, rows_are(found, piece.triangle_ids, expected[f]));
                if (rank == 0) moved += found.statistics.moved;
            }
        });
        EXPECT_TRUE(verdicts.all());
        EXPECT_GT(moved, frames / 2);
        EXPECT_LT(moved, frames);  // in some frames the scene has left the box of the centres
    }
}

/// Returns the soup at a time from 0 to 1, in units of `unit`. Each triangle moves to the initial place of another one,
/// so that triangles from different places meet.
WholeMesh mingled(const WholeMesh& soup, double time, double unit) {
    WholeMesh mesh = soup;
    const auto& from = std::get<std::vector<double>>(soup.vertices);
    auto& xyz = std::get<std::vector<double>>(mesh.vertices);
    const std::size_t triangles = from.size() / 9;
    for (std::size_t i = 0; i < xyz.size(); ++i) {
        const std::size_t t = i / 9, other = (37 * t + 11) % triangles, axis = i % 3;
        xyz[i] = unit * (from[i] + time * (from[9 * other + axis] - from[9 * t + axis]));
    }
    return mesh;
}

// One of the scenes is so small that squares of displacements underflow to 0.
TEST(Ranks, pairs_match_a_single_detector_while_triangles_change_places) {
    const WholeMesh soup(random_soup<double>(400, 0.15));
    constexpr int frames = 12;
    for (const double unit : {1.0, 1e-170}) {
        std::vector<WholeMesh> meshes;
        std::vector<Intersections> expected;
        for (int f = 0; f < frames; ++f) {
            meshes.push_back(mingled(soup, f / (frames - 1.0), unit));
            expected.push_back(result_of_one(meshes.back()));
        }
        RankFailures verdicts;
        int moved = 0;
        run_ranks(2, [&](Transport& transport) {
            WholeMesh now = meshes[0];
            MeshPiece piece(now, Distribution::random, transport.rank(), 2);
            RankDetector detector(transport, one_thread(12));
            detector.set_clock([] { return 0.0; });
            for (std::size_t f = 0; f < frames; ++f) {
                now.vertices = meshes[f].vertices;
                piece.follow();
                const DistributedIntersections& found = detector.find(piece.local());
                verdicts.add(transport.rank(), rows_are(found, piece.triangle_ids, expected[f]));
                if (transport.rank() == 0) moved += found.statistics.moved;
            }
        });
        EXPECT_TRUE(verdicts.all()) << unit;
        EXPECT_GT(moved, frames / 2);
    }
}

/// Time of a pretended clock, of each rank (thread). Each reading advances it by time_of_search.
thread_local double time_now = 0, time_of_search = 0;
double fake_clock() { return time_now += time_of_search; }

TEST(Ranks, parts_move_away_from_a_slow_rank) {
    const WholeMesh mesh(wavy_sheet<float>(24));
    const Intersections expected = result_of_one(mesh);
    constexpr int ranks = 3;
    std::vector<std::vector<int>> parts(ranks);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const int rank = transport.rank();
        time_of_search = rank == 0 ? 100 : 1;
        const MeshPiece piece(mesh, Distribution::blocks, rank, ranks);
        RankDetector detector(transport, one_thread(9));
        detector.set_clock(fake_clock);
        for (int frame = 0; frame < 4; ++frame) {
            const DistributedIntersections& found = detector.find(piece.local());
            verdicts.add(rank, rows_are(found, piece.triangle_ids, expected));
            parts[static_cast<std::size_t>(rank)].push_back(found.statistics.parts);
        }
    });
    EXPECT_TRUE(verdicts.all());
    EXPECT_GT(parts[0].front(), 1);
    EXPECT_LT(parts[0].back(), parts[0].front());
    EXPECT_EQ(parts[0].back() + parts[1].back() + parts[2].back(), 9);
}

TEST(Ranks, progress_shows_each_phase_and_part_once) {
    constexpr int ranks = 3;
    const WholeMesh mesh(wavy_sheet<float>(20));
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::round_robin, transport.rank(), ranks);
        RankDetector detector(transport, one_thread(9, 1024));  // batches so small that phases alternate
        std::vector<DistributedProgress> seen;
        detector.set_progress([&](const DistributedProgress& progress) { seen.push_back(progress); });
        for (int frame = 0; frame < 2; ++frame) {
            seen.clear();
            const DistributedStatistics did = detector.find(piece.local()).statistics;
            std::vector<Phase> phases;
            std::vector<int> done;
            bool even = true;
            for (const DistributedProgress& at : seen) {
                const bool searches = at.phase == Phase::search;
                even = even && at.parts == (searches ? did.parts : 0);
                if (searches) done.push_back(at.parts_done);
                if (at.parts_done == 0) phases.push_back(at.phase);
            }
            std::vector<int> all_parts(static_cast<std::size_t>(did.parts) + 1);
            std::iota(all_parts.begin(), all_parts.end(), 0);
            const bool ascend =
                std::adjacent_find(phases.begin(), phases.end(), std::greater_equal<>()) == phases.end();
            // In the second frame no triangle has changed, so centres are not recomputed, and one phase is missing.
            const std::size_t count = phase_count - (frame == 0 ? 0 : 1);
            if (!even || !ascend || done != all_parts || did.parts == 0 || phases.size() != count)
                verdicts.add(transport.rank(), testing::AssertionFailure() << "frame " << frame << ": " << phases.size()
                                                                           << " phases, " << did.parts << " parts");
        }
        seen.clear();
        detector.set_progress({});
        count_pairs(detector, piece.local());
        if (!seen.empty()) verdicts.add(transport.rank(), testing::AssertionFailure() << "still shown");
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(Ranks, pairs_match_a_single_detector_after_triangles_groups_or_precision_change) {
    WholeMesh mesh(wavy_sheet<float>(16));
    const auto torn = [&] {
        WholeMesh other = mesh;
        for (std::size_t i = 0; i < other.corners.size(); i += 33) other.corners[i] = other.corners[i + 1];
        return other;
    }();
    WholeMesh grouped = mesh, wide = mesh;
    for (std::int64_t t = 0; t < mesh.triangles(); ++t) grouped.groups.push_back(static_cast<std::int32_t>(t % 3));
    WholeMesh regrouped = grouped;
    std::reverse(regrouped.groups.begin(), regrouped.groups.end());
    std::vector<double> xyz;
    for (const float x : std::get<0>(mesh.vertices)) xyz.push_back(1.0000001 * x);
    wide.vertices = xyz;
    const IntersectionQuery between{.output = Output::contacts, .filter = {.groups = PairScope::between}},
        all{.output = Output::contacts};
    struct Step {
        const WholeMesh* mesh;
        Distribution how;
        const IntersectionQuery* query;
    };
    const std::vector<Step> steps{
        {&mesh, Distribution::blocks, &all},          {&torn, Distribution::blocks, &all},
        {&torn, Distribution::round_robin, &all},     {&grouped, Distribution::round_robin, &between},
        {&regrouped, Distribution::random, &between}, {&mesh, Distribution::all_on_one, &all},
        {&wide, Distribution::blocks, &all},          {&mesh, Distribution::blocks, &all}};
    std::vector<Intersections> expected;
    for (const Step& step : steps) expected.push_back(result_of_one(*step.mesh, *step.query));
    RankFailures verdicts;
    run_ranks(3, [&](Transport& transport) {
        const int rank = transport.rank();
        RankDetector detector(transport, one_thread());
        for (std::size_t i = 0; i < steps.size(); ++i) {
            const MeshPiece piece(*steps[i].mesh, steps[i].how, rank, 3);
            for (int twice = 0; twice < 2; ++twice)
                verdicts.add(rank,
                             rows_are(detector.find(piece.local(), *steps[i].query), piece.triangle_ids, expected[i]));
        }
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(Ranks, float64_on_one_rank_and_float32_on_others_match_a_single_detector) {
    // The sheet has vertices on several ranks. The soup has none, and the coordinates of rank 1 are no float32 numbers.
    WholeMesh sheet(wavy_sheet<float>(16));
    sheet.vertices = std::vector<double>(std::get<0>(sheet.vertices).begin(), std::get<0>(sheet.vertices).end());
    Soup<double> soup = random_soup<double>(300, 0.2);
    for (std::int64_t t = 0; t < 300; ++t)
        if (rank_of_triangle(Distribution::random, t, 300, 3) != 1)
            for (const std::int32_t v : soup.triangles[static_cast<std::size_t>(t)])
                for (double& x : soup.vertices[static_cast<std::size_t>(v)]) x = static_cast<float>(x);
    for (const WholeMesh& wide : {sheet, WholeMesh(soup)}) {
        WholeMesh mesh = wide;
        std::vector<float> rounded;
        for (const double x : std::get<1>(wide.vertices)) rounded.push_back(static_cast<float>(x));
        mesh.vertices = rounded;
        const Intersections expected = result_of_one(wide, {.output = Output::contacts});
        RankFailures verdicts;
        run_ranks(3, [&](Transport& transport) {
            const int rank = transport.rank();
            const MeshPiece piece(rank == 1 ? wide : mesh, Distribution::random, rank, 3);
            RankDetector detector(transport, one_thread());
            verdicts.add(rank, rows_are(detector.find(piece.local(), IntersectionQuery{.output = Output::contacts}),
                                        piece.triangle_ids, expected));
        });
        EXPECT_TRUE(verdicts.all());
    }
}

}  // namespace
}  // namespace crumple::test
