// Compares MPI processes with a single detector: one mpirun for each number of ranks runs all tests. Every rank
// computes the result of a single detector itself and compares its own rows. Tests make collective calls before they
// check results, since a failed check must not skip a collective call.

#include "crumple/mpi.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "agreement/hard_soups.h"
#include "crumple/crumple.h"
#include "distributed/feature_rows.h"
#include "distributed/last_frame.h"
#include "distributed/rank_overlap_rows.h"
#include "distributed/rank_worlds.h"
#include "error_of.h"
#include "io/files.h"
#include "rounds.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

int rank_in_world() {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}
int ranks_in_world() {
    int ranks = 0;
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    return ranks;
}

DistributedOptions one_thread() {
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    return options;
}

class MpiRanks : public testing::Test {
   protected:
    void expect_same(const WholeMesh& mesh, std::span<const Distribution> each, const IntersectionQuery& query,
                     const std::string& name, const DistributedOptions& options = one_thread()) const {
        Detector one({.backend = Backend::cpu, .threads = 1});
        const Intersections& expected = one.find(mesh.view(), query);
        for (const Distribution how : each) {
            const MeshPiece piece(mesh, how, rank, ranks);
            mpi::Detector detector(MPI_COMM_WORLD, options);
            const DistributedIntersections found = detector.find(piece.local(), query);
            const bool any = detector.any(piece.local(), query);
            const std::int64_t count = count_pairs(detector, piece.local(), query);
            detector.close();
            EXPECT_TRUE(rows_are(found, piece.triangle_ids, expected)) << name << ", rank " << rank;
            EXPECT_EQ(any, !expected.pairs.empty()) << name;
            EXPECT_EQ(count, static_cast<std::int64_t>(expected.pairs.size())) << name;
        }
    }
    const int rank = rank_in_world(), ranks = ranks_in_world();
};

TEST_F(MpiRanks, hard_soups_match_a_single_detector) {
    if (sanitized) GTEST_SKIP() << "distribute_test has these soups under sanitizers";
    std::size_t number = 0;
    for (const NamedMesh& soup : hard_soups()) {
        const WholeMesh mesh(soup.mesh);
        expect_same(mesh, every_distribution,
                    {.output = number % 2 == 0 ? Output::contacts : Output::pairs, .weld = number % 3 == 0}, soup.name);
        ++number;
    }
}

TEST_F(MpiRanks, scenes_match_a_single_detector) {
    for (const scenes::Description& scene : scenes::descriptions()) {
        const WholeMesh mesh = last_frame(scene, 1000);
        expect_same(mesh, every_distribution, {.output = Output::contacts}, std::string(scene.name));
    }
}

TEST_F(MpiRanks, real_scenes_match_a_single_detector) {
    const auto folder = io::test::data_folder();
    if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
    const bool usual = (ranks == 2 || ranks == 3) && !sanitized;
    if (!usual && !thorough()) GTEST_SKIP() << "only with CRUMPLE_ROUNDS";
    std::size_t number = 0;
    for (const char* name :
         {"soups/soup_degenerate.ply", "soups/soup_grid.ply", "soups/soup_huge32.ply", "soups/soup_tiny64.ply",
          "ipc-toolkit-test-data/spike-plane.ply", "meshes/self_intersectA_17k.obj", "meshes/truck.obj",
          "scalable-ccd/cloth-ball/frames/cloth_ball92.ply", "scalable-ccd/cloth-funnel/frames/227.ply",
          "scalable-ccd/n-body-simulation/frames/balls16_18.ply"}) {
        const WholeMesh mesh(io::read_mesh(*folder / name, {.triangulation = io::Triangulation::fan}));
        expect_same(mesh, std::span(every_distribution).subspan(number++ % 4, 1), {.output = Output::contacts}, name);
    }
}

TEST_F(MpiRanks, impacts_and_proximities_match_a_single_detector) {
    Detector one({.backend = Backend::cpu, .threads = 1});
    mpi::Detector detector(MPI_COMM_WORLD, one_thread());
    for (const NamedMove<double>& soup : moving_soups<double>(0.5)) {
        const Step step(soup.soup);
        const ProximityQuery near{.radius = 0.25, .closest = true};
        const Impacts expected = one.find(step.start.view().moving_to(step.end_view()), ImpactQuery());
        const Proximities& expected_nearby = one.find(step.start.view(), near);
        for (const Distribution how : {Distribution::blocks, Distribution::random}) {
            const MeshPiece start(step.start, how, rank, ranks), end(step.end, how, rank, ranks);
            const DistributedImpacts impacts =
                detector.find(start.local().moving_to(end.local().mesh.vertices), ImpactQuery());
            const DistributedProximities nearby = detector.find(start.local(), near);
            EXPECT_TRUE(rows_are(impacts, start.triangle_ids, expected, step.start)) << soup.name;
            EXPECT_TRUE(impacts.first == expected.first) << soup.name;
            EXPECT_TRUE(rows_are(nearby, start.triangle_ids, expected_nearby, step.start)) << soup.name;
        }
    }
    detector.close();
}

TEST_F(MpiRanks, bodies_match_a_single_detector) {
    Detector one({.backend = Backend::cpu, .threads = 1});
    mpi::Detector detector(MPI_COMM_WORLD, one_thread());
    WorldKind kind;
    kind.bodies = 9, kind.everywhere = 0, kind.named = 0, kind.reach = 0.3;
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const auto random = random_world(seed, kind);
        std::vector<Pose> ends(random->bodies.size());
        for (std::size_t b = 0; b < ends.size(); ++b) ends[b].rows[3] = 0.1 * static_cast<double>(b);
        World world = random->view();
        world.end_poses = ends;
        const WorldPiece piece(world, every_distribution[seed % 4], rank, ranks);
        const IntersectionQuery query{.output = seed % 2 ? Output::contacts : Output::body_pairs};
        const DistributedIntersections found = detector.find(piece.local(), query);
        const DistributedImpacts impacts = detector.find(piece.local(), ImpactQuery());
        const ProximityQuery near{.radius = 0.05, .closest = true};
        const DistributedProximities nearby = detector.find(piece.local(), near);
        EXPECT_TRUE(rows_are(found, piece, one.find(world, query))) << seed;
        EXPECT_TRUE(feature_rows_are(impacts, piece, one.find(world, ImpactQuery()))) << seed;
        EXPECT_TRUE(feature_rows_are(nearby, piece, one.find(world, near))) << seed;
    }
    detector.close();
}

TEST_F(MpiRanks, overlaps_match_a_single_detector) {
    Detector one({.backend = Backend::cpu, .threads = 1});
    mpi::Detector detector(MPI_COMM_WORLD, one_thread());
    for (unsigned seed = 1; seed <= 4; ++seed) {
        const ClosedBodies bodies = closed_bodies(seed, 9, seed % 2 == 0, false);
        const WorldPiece piece(bodies.view(), every_distribution[seed % 4], rank, ranks);
        const DistributedOverlaps found = detector.find(piece.local(), all_but_first_free);
        const bool any = detector.any(piece.local(), OverlapQuery());
        const Overlaps& expected = one.find(bodies.view(), all_but_first_free);
        EXPECT_GT(expected.count, 3) << seed;
        EXPECT_TRUE(overlaps_are(found, piece, expected)) << seed;
        EXPECT_EQ(any, one.any(bodies.view(), OverlapQuery())) << seed;
    }
    const WholeMesh mesh(pieces(5, 8, true));
    const Overlaps& expected = one.find(mesh.view(), all_but_first_free);
    EXPECT_EQ(expected.count, 1);
    for (const Distribution how : every_distribution) {
        const MeshPiece piece(mesh, how, rank, ranks);
        EXPECT_TRUE(
            is_overlap_of_mesh(detector.find(piece.local(), all_but_first_free), piece, all_but_first_free, expected));
    }
    detector.close();
}

TEST_F(MpiRanks, small_message_batches_match_a_single_detector) {
    DistributedOptions options = one_thread();
    options.batch_bytes = 1024;
    expect_same(WholeMesh(wavy_sheet<double>(24)), every_distribution, {.output = Output::contacts}, "wavy sheet",
                options);
}

TEST_F(MpiRanks, moving_scene_matches_a_single_detector) {
    const WholeMesh start(wavy_sheet<float>(30));
    WholeMesh now = start;
    MeshPiece piece(now, Distribution::random, rank, ranks);
    mpi::Detector detector(MPI_COMM_WORLD, one_thread());
    Detector one({.backend = Backend::cpu, .threads = 1});
    for (int frame = 0; frame < 20; ++frame) {
        auto& xyz = std::get<0>(now.vertices);
        for (std::size_t i = 0; i < xyz.size(); ++i)
            xyz[i] = std::get<0>(start.vertices)[i] +
                     0.03f * std::sin(static_cast<float>(frame) + 0.01f * static_cast<float>(i % 700));
        piece.follow();
        const DistributedIntersections& found = detector.find(piece.local());
        EXPECT_TRUE(rows_are(found, piece.triangle_ids, one.find(now.view()))) << "frame " << frame;
    }
    detector.close();
}

TEST_F(MpiRanks, error_is_the_same_on_all_ranks_and_later_calls_succeed) {
    const WholeMesh mesh(wavy_sheet<float>(16));
    const MeshPiece good(mesh, Distribution::blocks, rank, ranks);
    mpi::Detector detector(MPI_COMM_WORLD, one_thread());
    Detector one({.backend = Backend::cpu, .threads = 1});
    for (int failing = 0; failing < ranks; ++failing) {
        MeshPiece bad = good;
        if (rank == failing) std::get<0>(bad.vertices)[7] = std::numeric_limits<float>::quiet_NaN();
        const Error error = error_of([&] { detector.find(bad.local()); });
        const DistributedIntersections& found = detector.find(good.local());
        std::array<char, 256> message{};
        std::string(error.what()).copy(message.data(), message.size() - 1);
        std::array<char, 256> of_rank_0 = message;
        MPI_Bcast(of_rank_0.data(), static_cast<int>(of_rank_0.size()), MPI_CHAR, 0, MPI_COMM_WORLD);
        EXPECT_STREQ(message.data(), of_rank_0.data());
        EXPECT_EQ(error.code, ErrorCode::not_finite);
        EXPECT_EQ(error.rank, failing);
        EXPECT_TRUE(rows_are(found, good.triangle_ids, one.find(mesh.view())));
    }
    detector.close();
    EXPECT_EQ(error_of([&] { count_pairs(detector, good.local()); }).code, ErrorCode::communication);
}

TEST_F(MpiRanks, threads_of_all_ranks_are_no_more_than_cores_or_ranks) {
    mpi::Detector detector(MPI_COMM_WORLD, {});
    EXPECT_GE(detector.options().detector.threads, 1);
    int threads = detector.options().detector.threads;
    MPI_Allreduce(MPI_IN_PLACE, &threads, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_LE(threads, std::max(ranks, static_cast<int>(std::thread::hardware_concurrency())));
    EXPECT_EQ(detector.rank(), rank);
    EXPECT_EQ(detector.ranks(), ranks);
    detector.close();
    detector.close();
    EXPECT_STREQ(error_of([] { mpi::Detector of_nobody(MPI_COMM_NULL); }).what(), "the communicator is MPI_COMM_NULL");
}

}  // namespace
}  // namespace crumple::test

int main(int count, char** arguments) {
    int level = 0;
    MPI_Init_thread(&count, &arguments, MPI_THREAD_FUNNELED, &level);
    testing::InitGoogleTest(&count, arguments);
    if (crumple::test::rank_in_world() != 0) {
        // Other ranks print failures only.
        testing::GTEST_FLAG(brief) = true;
    }
    int failed = RUN_ALL_TESTS();
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return failed;
}
