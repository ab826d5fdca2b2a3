// Compares overlaps of bodies on many ranks with those of a single detector, byte by byte.

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <stop_token>
#include <string>
#include <vector>

#include "distributed/overlaps/overlap_messages.h"
#include "distributed/rank_detector.h"
#include "distributed/rank_failures.h"
#include "distributed/rank_overlap_rows.h"
#include "distributed/thread_ranks.h"
#include "error_of.h"
#include "overlaps/joined_rows.h"
#include "rounds.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

constexpr std::array counts_of_ranks{1, 2, 3, 5, 9};

DistributedOptions for_overlaps() {
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    return options;
}

testing::AssertionResult same_overlaps(const World& world, Distribution how, int ranks, const OverlapQuery& query,
                                       const DistributedOptions& options = for_overlaps()) {
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Overlaps& expected = one.find(world, query);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const WorldPiece piece(world, how, transport.rank(), ranks);
        RankDetector detector(transport, options);
        verdicts.add(transport.rank(), overlaps_are(detector.find(piece.local(), query), piece, expected));
    });
    return verdicts.all();
}

TEST(RankOverlaps, everything_matches_a_single_detector) {
    std::size_t rows = 0;
    for (unsigned seed = 0; seed < (sanitized ? 5u : 20u); ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 2 + static_cast<int>(seed % 9), seed % 2 == 0, seed % 3 == 0);
        Detector one({.backend = Backend::cpu, .threads = 1});
        rows += one.find(bodies.view(), OverlapQuery()).bodies.size();
        ASSERT_TRUE(same_overlaps(bodies.view(), every_distribution[seed % 4], counts_of_ranks[seed % 5],
                                  seed < 5 ? everything : all_but_first_free));
    }
    EXPECT_GT(rows, sanitized ? 10u : 200u);
}

TEST(RankOverlaps, every_output_and_filter_matches_a_single_detector) {
    const ClosedBodies bodies = closed_bodies(31, 9, true, false);
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::pairs})
        for (const int ranks : {1, 2, 5})
            for (const bool self : {false, true}) {
                SCOPED_TRACE(testing::Message() << static_cast<int>(output) << ", " << ranks << " ranks");
                OverlapQuery query{.output = output, .min_volume = self ? 0.25 : 0, .self_overlaps = self};
                query.translation = true;
                query.solids = true;
                ASSERT_TRUE(same_overlaps(bodies.view(), Distribution::round_robin, ranks, query));
                query.filter = {.groups = PairScope::between, .excluded_bodies = {{0, 1}, {4, 2}, {3, 3}}};
                ASSERT_TRUE(same_overlaps(bodies.view(), Distribution::random, ranks, query));
                query.filter = {.bodies = PairScope::between, .excluded_groups = {{1, 0}}};
                ASSERT_TRUE(same_overlaps(bodies.view(), Distribution::blocks, ranks, query));
            }
}

// A shape of which a pose mirrors one body must not be turned inside out, and vertices are welded before they are
// posed.
TEST(RankOverlaps, shared_mirrored_flattened_and_welded_shapes_match_a_single_detector) {
    ClosedBodies bodies = closed_bodies(33, 8, true, false);
    for (std::size_t b = 0; b < 8; ++b) bodies.bodies[b].shape = static_cast<std::int32_t>(b % 3);
    for (const std::size_t b : {std::size_t{1}, std::size_t{5}})
        bodies.poses[b].rows = {-1, 0, 0, 3, 0, 1, 0, 0.125, 0, 0, 1, 0.25};
    bodies.poses[2].rows = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1};
    bodies.poses[7].rows = {0.6, -0.8, 0, 1, 0.8, 0.6, 0, 0, 0, 0, 1, 0.5};
    Soup<float> single{{}, bodies.soups[0].triangles, {}};
    for (const auto& [x, y, z] : bodies.soups[0].vertices)
        single.vertices.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    bodies.shapes[0] = Shape(single.view());
    OverlapQuery query = all_but_first_free;
    Detector one({.backend = Backend::cpu, .threads = 1});
    EXPECT_GT(one.find(bodies.view(), OverlapQuery()).count, 5);
    for (const bool weld : {false, true})
        for (const Distribution how : every_distribution) {
            query.weld = weld;
            ASSERT_TRUE(same_overlaps(bodies.view(), how, 3, query));
        }
}

TEST(RankOverlaps, open_bodies_are_skipped_have_curves_or_are_the_same_error_on_all_ranks) {
    ClosedBodies bodies = closed_bodies(35, 9, true, false);
    for (const std::size_t b : {std::size_t{2}, std::size_t{6}}) {
        bodies.soups[b].triangles.pop_back();
        bodies.shapes[b] = Shape(bodies.soups[b].view());
    }
    OverlapQuery query = all_but_first_free;
    for (const bool self : {false, true})
        for (const OpenSurfaces open : {OpenSurfaces::skip, OpenSurfaces::curves})
            for (const int ranks : {2, 5}) {
                query.open = open, query.self_overlaps = self;
                ASSERT_TRUE(same_overlaps(bodies.view(), Distribution::round_robin, ranks, query));
            }
    Detector one({.backend = Backend::cpu, .threads = 1});
    const std::string expected = error_of([&] { one.find(bodies.view(), OverlapQuery()); }).what();
    std::vector<std::string> messages(3);
    run_ranks(3, [&](Transport& transport) {
        const WorldPiece piece(bodies.view(), Distribution::round_robin, transport.rank(), 3);
        RankDetector detector(transport, for_overlaps());
        try {
            detector.find(piece.local(), OverlapQuery());
        } catch (const Error& error) {
            messages[static_cast<std::size_t>(transport.rank())] = error.what();
        }
    });
    EXPECT_EQ(messages, std::vector<std::string>(3, "rank 2: " + expected));
}

TEST(RankOverlaps, rows_of_ranks_with_blocks_of_bodies_follow_each_other) {
    const ClosedBodies bodies = closed_bodies(36, 10, true, false);
    Detector one({.backend = Backend::cpu, .threads = 1});
    Overlaps expected = one.find(bodies.view(), all_but_first_free);
    std::vector<Overlaps> found(4);
    run_ranks(4, [&](Transport& transport) {
        const WorldPiece piece(bodies.view(), Distribution::blocks, transport.rank(), 4);
        LocalWorld local = piece.local();
        local.body_ids = {};
        RankDetector detector(transport, for_overlaps());
        found[static_cast<std::size_t>(transport.rank())] = detector.find(local, all_but_first_free).rows;
    });
    JoinedRows joined;
    for (const Overlaps& rows : found) joined.add(rows);
    expected.world_hit.clear(), expected.body_volume.clear(), expected.is_solid.clear();
    EXPECT_EQ(difference(joined.result, expected), "");
}

TEST(RankOverlaps, detector_alternates_between_queries_and_moving_bodies) {
    ClosedBodies bodies = closed_bodies(37, 8, true, false);
    Detector one({.backend = Backend::cpu, .threads = 1});
    RankFailures verdicts;
    std::vector<World> frames;
    std::vector<std::vector<Pose>> poses(3, bodies.poses);
    for (std::size_t frame = 0; frame < poses.size(); ++frame) {
        for (std::size_t b = 0; b < poses[frame].size(); ++b)
            poses[frame][b].rows[3] = 0.25 * static_cast<double>(frame * b);
        frames.push_back({bodies.shapes, bodies.bodies, poses[frame]});
    }
    run_ranks(3, [&](Transport& transport) {
        RankDetector detector(transport, for_overlaps());
        Detector single({.backend = Backend::cpu, .threads = 1});
        for (const World& world : frames) {
            const WorldPiece piece(world, Distribution::random, transport.rank(), 3);
            verdicts.add(transport.rank(), rows_are(detector.find(piece.local(), IntersectionQuery()), piece,
                                                    single.find(world, IntersectionQuery())));
            verdicts.add(transport.rank(), overlaps_are(detector.find(piece.local(), all_but_first_free), piece,
                                                        single.find(world, all_but_first_free)));
        }
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(RankOverlaps, few_bodies_empty_ranks_and_small_batches_match_a_single_detector) {
    DistributedOptions options = for_overlaps();
    options.batch_bytes = 1024;
    for (const int count : {2, 3, 7}) {
        const ClosedBodies bodies = closed_bodies(38, count, true, false);
        for (const Distribution how : {Distribution::all_on_one, Distribution::blocks})
            ASSERT_TRUE(same_overlaps(bodies.view(), how, 5, all_but_first_free, options));
    }
    ASSERT_TRUE(same_overlaps({}, Distribution::blocks, 3, all_but_first_free));
}

TEST(RankOverlaps, work_is_divided_and_bodies_are_sent_only_to_ranks_that_search_them) {
    const ClosedBodies bodies = closed_bodies(39, 40, true, false);
    constexpr std::size_t ranks = 4;
    std::vector<DistributedStatistics> of_rank(ranks);
    run_ranks(ranks, [&](Transport& transport) {
        const WorldPiece piece(bodies.view(), Distribution::all_on_one, transport.rank(), ranks);
        RankDetector detector(transport, for_overlaps());
        of_rank[static_cast<std::size_t>(transport.rank())] = detector.find(piece.local(), OverlapQuery()).statistics;
    });
    std::int64_t largest = 0, all = 0;
    for (const DistributedStatistics& statistics : of_rank) {
        const std::int64_t work = statistics.members + 64 * statistics.parts;  // as assign() estimates it
        largest = std::max(largest, work), all += work;
        EXPECT_GT(statistics.parts, 0);
        EXPECT_GT(statistics.largest_work, 0);
    }
    EXPECT_LT(static_cast<double>(largest), 1.15 * static_cast<double>(all) / static_cast<double>(ranks));
    Detector one({.backend = Backend::cpu, .threads = 1});
    const World apart{bodies.shapes, std::span(bodies.bodies).first(1), std::span(bodies.poses).first(1)};
    run_ranks(2, [&](Transport& transport) {
        const WorldPiece piece(apart, Distribution::all_on_one, transport.rank(), 2);
        RankDetector detector(transport, for_overlaps());
        of_rank[static_cast<std::size_t>(transport.rank())] =
            detector.find(piece.local(), OverlapQuery{.self_overlaps = true}).statistics;
    });
    EXPECT_EQ(of_rank[1].parts, 1);  // the rank that has the body
    EXPECT_EQ(of_rank[1].bytes_sent, of_rank[0].bytes_sent);
}

/// Makes a call on three ranks whose arguments spoil(rank, piece, query) has made invalid. Returns the message, or all
/// messages if ranks differ. Expects a valid call to work afterwards.
template <class Spoil>
std::string refusal_of_overlaps(Spoil spoil) {
    const ClosedBodies bodies = closed_bodies(40, 6, true, false);
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Overlaps expected = one.find(bodies.view(), OverlapQuery());
    std::vector<std::string> messages(3);
    run_ranks(3, [&](Transport& transport) {
        const auto rank = static_cast<std::size_t>(transport.rank());
        const WorldPiece good(bodies.view(), Distribution::round_robin, transport.rank(), 3);
        RankDetector detector(transport, for_overlaps());
        WorldPiece piece = good;
        OverlapQuery query;
        spoil(transport.rank(), piece, query);
        try {
            detector.find(piece.local(), query);
            messages[rank] = "nothing";
        } catch (const Error& error) {
            messages[rank] = error.what();
        }
        if (!overlaps_are(detector.find(good.local(), OverlapQuery()), good, expected))
            messages[rank] += ", and does not go on";
    });
    return messages[1] == messages[0] && messages[2] == messages[0]
               ? messages[0]
               : messages[0] + "; " + messages[1] + "; " + messages[2];
}

TEST(RankOverlaps, invalid_calls_fail_alike_on_all_ranks) {
    EXPECT_EQ(refusal_of_overlaps([](int rank, WorldPiece&, OverlapQuery& query) { query.curves = rank == 1; }),
              "rank 0: the query and the options must be the same on all ranks");
    EXPECT_EQ(refusal_of_overlaps([](int rank, WorldPiece&, OverlapQuery& query) {
                  query.directions = {{1.0, 0.0, rank == 1 ? 1.0 : 0.0}};
              }),
              "rank 0: the query and the options must be the same on all ranks");
    EXPECT_EQ(
        refusal_of_overlaps([](int, WorldPiece&, OverlapQuery& query) { query.filter.bodies = PairScope::within; }),
        "rank 0: filter.bodies must not be within: overlaps are between bodies");
    EXPECT_EQ(refusal_of_overlaps([](int, WorldPiece&, OverlapQuery& query) {
                  query.filter.excluded_bodies = {{0, 6}};
              }),
              "rank 0: excluded_bodies names body 6 of 6");
    EXPECT_EQ(refusal_of_overlaps([](int rank, WorldPiece& piece, OverlapQuery&) {
                  if (rank == 1) piece.ids[0] = 0;
              }),
              "rank 0: body 0 is provided 2 times");
    EXPECT_EQ(refusal_of_overlaps([](int rank, WorldPiece& piece, OverlapQuery&) {
                  if (rank == 1) piece.poses[1].rows[3] = std::numeric_limits<double>::infinity();
              }),
              "rank 1: body 1: its pose is not finite (body 4 over all ranks)");
    EXPECT_EQ(refusal_of_overlaps([](int rank, WorldPiece& piece, OverlapQuery&) {
                  static const Soup<double> wrong{{{0, 0, 0}}, {{0, 0, 7}}, {}};
                  if (rank == 2) piece.shapes[1] = Shape(wrong.view());
              }),
              "rank 2: body 1: triangle 0 names vertex 7 of 1 (body 5 over all ranks)");
}

TEST(RankOverlaps, memory_meter_counts_rows_that_are_sent_and_received) {
    const ClosedBodies bodies = closed_bodies(42, 20, false, false);
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Overlaps rows = one.find(bodies.view(), OverlapQuery{.curves = true});
    const auto message = static_cast<std::int64_t>(distribute::packed_rows(rows).size());
    for (const std::int64_t limit : {std::int64_t{0}, message}) {
        std::array<std::int64_t, 2> peaks{}, left{};
        std::array<bool, 2> failed{};
        run_ranks(2, [&](Transport& transport) {
            const auto rank = static_cast<std::size_t>(transport.rank());
            MemoryMeter meter;
            if (rank == 0) meter.limit = limit;
            {
                distribute::MessageBatches batches(transport, 1 << 16);
                distribute::CollectiveCheck agree(transport);
                distribute::OverlapMessages messages(2, meter);
                Overlaps received;
                try {
                    agree(Phase::rows,
                          [&] { append_rows(rows, 0, rows.bodies.size(), messages.for_rank(rank == 0 ? 1 : 0)); });
                    messages.exchange(batches, agree, received);
                } catch (const Error& error) {
                    failed[rank] = error.code == ErrorCode::memory_limit;
                }
            }
            peaks[rank] = meter.peak, left[rank] = meter.used;
        });
        for (std::size_t rank = 0; rank < 2; ++rank) {
            EXPECT_EQ(failed[rank], limit > 0);
            EXPECT_EQ(left[rank], 0);
            EXPECT_TRUE(limit > 0 || peaks[rank] > 2 * message) << peaks[rank];
        }
    }
}

TEST(RankOverlaps, stop_and_memory_limit_of_one_rank_end_the_call_on_all) {
    const ClosedBodies bodies = closed_bodies(41, 20, true, false);
    std::vector<ErrorCode> stopped(3, ErrorCode::invalid_argument), limited(3, ErrorCode::invalid_argument);
    std::stop_source source;
    run_ranks(3, [&](Transport& transport) {
        const auto rank = static_cast<std::size_t>(transport.rank());
        const WorldPiece piece(bodies.view(), Distribution::blocks, transport.rank(), 3);
        DistributedOptions options = for_overlaps();
        if (rank == 1) options.detector.memory_limit = 20'000;
        RankDetector detector(transport, for_overlaps()), small(transport, options);
        detector.set_hook([&](Phase phase) {
            if (rank == 2 && phase == Phase::search) source.request_stop();
        });
        try {
            detector.find(piece.local(), all_but_first_free, rank == 2 ? source.get_token() : std::stop_token());
        } catch (const Error& error) {
            stopped[rank] = error.code;
        }
        try {
            small.find(piece.local(), all_but_first_free);
        } catch (const Error& error) {
            limited[rank] = error.code;
        }
    });
    EXPECT_EQ(stopped, std::vector<ErrorCode>(3, ErrorCode::cancelled));
    EXPECT_EQ(limited, std::vector<ErrorCode>(3, ErrorCode::memory_limit));
}

}  // namespace
}  // namespace crumple::test
