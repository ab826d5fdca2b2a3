// Compares the overlap of a mesh with itself, whose triangles are distributed over ranks, with that of a single
// detector, byte by byte.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "distributed/rank_detector.h"
#include "distributed/rank_failures.h"
#include "distributed/rank_meshes.h"
#include "distributed/rank_overlap_rows.h"
#include "distributed/thread_ranks.h"
#include "error_of.h"
#include "overlaps/closed_bodies.h"
#include "results/overlap_output.h"
#include "rounds.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

DistributedOptions for_meshes() {
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    return options;
}

testing::AssertionResult same_overlap(const WholeMesh& mesh, Distribution how, int ranks, const OverlapQuery& query,
                                      const DistributedOptions& options = for_meshes()) {
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Overlaps& expected = one.find(mesh.view(), query);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, how, transport.rank(), ranks);
        RankDetector detector(transport, options);
        verdicts.add(transport.rank(), is_overlap_of_mesh(detector.find(piece.local(), query), piece, query, expected));
    });
    return verdicts.all();
}

TEST(RankMeshOverlaps, everything_matches_a_single_detector) {
    constexpr std::array counts_of_ranks{1, 2, 3, 5, 9};
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < (sanitized ? 5u : 20u); ++seed) {
        SCOPED_TRACE(seed);
        const WholeMesh mesh(pieces(seed, 2 + static_cast<int>(seed % 9), seed % 2 == 0));
        Detector one({.backend = Backend::cpu, .threads = 1});
        rows += one.find(mesh.view(), everything).count;
        ASSERT_TRUE(same_overlap(mesh, every_distribution[seed % 4], counts_of_ranks[seed % 5], everything));
    }
    EXPECT_GT(rows, sanitized ? 3 : 12);
}

TEST(RankMeshOverlaps, every_output_matches_a_single_detector) {
    const WholeMesh mesh(pieces(31, 8, true));
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::pairs})
        for (const int ranks : {1, 2, 5})
            for (const double min_volume : {0.0, 0.25, 1e9}) {
                SCOPED_TRACE(testing::Message() << static_cast<int>(output) << ", " << ranks << " ranks");
                const OverlapQuery query{.output = output, .min_volume = min_volume};
                ASSERT_TRUE(same_overlap(mesh, Distribution::round_robin, ranks, query));
            }
}

TEST(RankMeshOverlaps, float32_groups_many_parts_and_small_batches_match_a_single_detector) {
    const Soup<double> soup = pieces(32, 12, true);
    Soup<float> single{{}, soup.triangles, std::vector<std::int32_t>(soup.triangles.size(), 1)};
    for (const auto& [x, y, z] : soup.vertices)
        single.vertices.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    DistributedOptions options = for_meshes();
    options.batch_bytes = 1024;
    options.parts = 30;
    for (const Distribution how : every_distribution)
        ASSERT_TRUE(same_overlap(WholeMesh(single), how, 3, {.gradient = true, .windings = true}, options));
}

TEST(RankMeshOverlaps, rank_0_has_the_result_of_a_mesh_without_triangles) {
    const WholeMesh mesh((Soup<double>()));
    run_ranks(3, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::all_on_one, transport.rank(), 3);
        RankDetector detector(transport, for_meshes());
        const DistributedOverlaps& found = detector.find(piece.local(), OverlapQuery());
        if (found.any || found.rows.body_volume.size() != (transport.rank() == 0 ? 1u : 0u))
            throw std::runtime_error("another result");
    });
}

TEST(RankMeshOverlaps, open_meshes_are_skipped_or_the_same_error_on_all_ranks) {
    Soup<double> soup = pieces(33, 5, true);
    soup.triangles.pop_back();
    const WholeMesh mesh(soup);
    ASSERT_TRUE(same_overlap(mesh, Distribution::blocks, 3, {.open = OpenSurfaces::skip}));
    Detector one({.backend = Backend::cpu, .threads = 1});
    const std::string expected = error_of([&] { one.find(mesh.view(), OverlapQuery()); }).what();
    std::vector<std::string> messages(3);
    run_ranks(3, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::blocks, transport.rank(), 3);
        RankDetector detector(transport, for_meshes());
        try {
            detector.find(piece.local(), OverlapQuery());
        } catch (const Error& error) {
            messages[static_cast<std::size_t>(transport.rank())] = error.what();
        }
    });
    EXPECT_EQ(messages, std::vector<std::string>(3, "rank 0: " + expected));
}

TEST(RankMeshOverlaps, detector_alternates_between_queries_and_moving_vertices) {
    WholeMesh mesh(pieces(34, 8, false));
    Detector one({.backend = Backend::cpu, .threads = 1});
    std::vector<WholeMesh> frames;
    for (int frame = 0; frame < 3; ++frame) {
        auto& xyz = std::get<std::vector<double>>(mesh.vertices);
        for (std::size_t i = 0; i < 12; ++i) xyz[i] += 0.125 * frame;
        frames.push_back(mesh);
    }
    RankFailures verdicts;
    run_ranks(3, [&](Transport& transport) {
        RankDetector detector(transport, for_meshes());
        Detector single({.backend = Backend::cpu, .threads = 1});
        for (const WholeMesh& frame : frames) {
            const MeshPiece piece(frame, Distribution::random, transport.rank(), 3);
            const OverlapQuery query{.gradient = true};
            verdicts.add(transport.rank(), rows_are(detector.find(piece.local(), IntersectionQuery()),
                                                    piece.triangle_ids, single.find(frame.view())));
            verdicts.add(transport.rank(), is_overlap_of_mesh(detector.find(piece.local(), query), piece, query,
                                                              single.find(frame.view(), query)));
        }
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(RankMeshOverlaps, mesh_and_world_on_different_ranks_are_an_error) {
    const WholeMesh mesh(pieces(35, 4, true));
    std::vector<std::string> messages(2);
    run_ranks(2, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::blocks, transport.rank(), 2);
        RankDetector detector(transport, for_meshes());
        try {
            if (transport.rank() == 0)
                detector.find(piece.local(), OverlapQuery());
            else
                detector.find(LocalWorld(), OverlapQuery());
        } catch (const Error& error) {
            messages[static_cast<std::size_t>(transport.rank())] = error.what();
        }
    });
    EXPECT_EQ(messages, std::vector<std::string>(2, "rank 0: the query and the options must be the same on all ranks"));
}

TEST(RankMeshOverlaps, stop_and_memory_limit_of_one_rank_end_the_call_on_all) {
    const WholeMesh mesh(pieces(36, 60, false));
    std::vector<ErrorCode> stopped(3, ErrorCode::invalid_argument), limited(3, ErrorCode::invalid_argument);
    std::stop_source source;
    run_ranks(3, [&](Transport& transport) {
        const auto rank = static_cast<std::size_t>(transport.rank());
        const MeshPiece piece(mesh, Distribution::round_robin, transport.rank(), 3);
        DistributedOptions options = for_meshes();
        if (rank == 0) options.detector.memory_limit = 100'000;
        RankDetector detector(transport, for_meshes()), small(transport, options);
        detector.set_hook([&](Phase phase) {
            if (rank == 2 && phase == Phase::rows) source.request_stop();
        });
        try {
            detector.find(piece.local(), OverlapQuery(), rank == 2 ? source.get_token() : std::stop_token());
        } catch (const Error& error) {
            stopped[rank] = error.code;
        }
        try {
            small.find(piece.local(), OverlapQuery());
        } catch (const Error& error) {
            limited[rank] = error.code;
        }
    });
    EXPECT_EQ(stopped, std::vector<ErrorCode>(3, ErrorCode::cancelled));
    EXPECT_EQ(limited, std::vector<ErrorCode>(3, ErrorCode::memory_limit));
}

}  // namespace
}  // namespace crumple::test
