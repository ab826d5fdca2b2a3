// Tests that an error on one rank becomes the same Error on all ranks, and that detectors work afterwards.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "distributed/rank_detector.h"
#include "distributed/rank_meshes.h"
#include "distributed/thread_ranks.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

constexpr int ranks = 3;

DistributedOptions small() {
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    return options;
}

/// Error of a call on one rank; the message is empty if there was none.
struct Seen {
    std::string message;
    ErrorCode code{};
    Element element{};
    std::int64_t index = 0, bytes_needed = 0;
    int rank = -2;
    bool operator==(const Seen&) const = default;
};
void PrintTo(const Seen& seen, std::ostream* out) {
    *out << seen.message << " (" << seen.index << ", " << seen.rank << ")";
}

template <class Call>
Seen seen_by(Call call) {
    try {
        call();
    } catch (const Error& e) {
        return {e.what(), e.code, e.element, e.index, e.bytes_needed, e.rank};
    }
    return {};
}

/// Makes calls on three ranks whose arguments spoil(rank, piece, query) has made invalid, and valid calls after them,
/// which must work. Returns the error of the invalid call, which must be the same on all ranks.
template <class Spoil>
Seen seen_by_all(Spoil spoil, const DistributedOptions& options = small()) {
    const WholeMesh mesh(wavy_sheet<float>(16));
    Detector one({.backend = Backend::cpu});
    const Intersections expected = one.find(mesh.view());
    std::vector<Seen> seen(ranks);
    std::vector<testing::AssertionResult> after(ranks, testing::AssertionSuccess());
    run_ranks(ranks, [&](Transport& transport) {
        const auto rank = static_cast<std::size_t>(transport.rank());
        const MeshPiece good(mesh, Distribution::blocks, transport.rank(), ranks);
        RankDetector detector(transport, options);
        for (int frame = 0; frame < 2; ++frame) {  // a first call, and one in which only vertices have moved
            MeshPiece piece = good;
            IntersectionQuery query;
            spoil(transport.rank(), piece, query);
            seen[rank] = seen_by([&] { detector.find(piece.local(), query); });
            after[rank] = rows_are(detector.find(good.local()), good.triangle_ids, expected);
            if (!after[rank]) return;
        }
    });
    for (std::size_t r = 0; r < ranks; ++r) {
        EXPECT_EQ(seen[r], seen[0]) << "rank " << r;
        EXPECT_TRUE(after[r]) << "rank " << r;
    }
    return seen[0];
}

TEST(RankErrors, error_in_any_phase_is_the_same_on_all_ranks) {
    const WholeMesh mesh(wavy_sheet<float>(16));
    Detector one({.backend = Backend::cpu});
    const Intersections expected = one.find(mesh.view());
    std::vector<int> failures(ranks, 0);
    std::vector<std::string> wrong(ranks);
    run_ranks(ranks, [&](Transport& transport) {
        const int rank = transport.rank();
        const auto r = static_cast<std::size_t>(rank);
        const MeshPiece piece(mesh, Distribution::random, rank, ranks);
        for (int phase = 0; phase < phase_count; ++phase)
            for (int failing = 0; failing < ranks; ++failing)
                for (const bool warm : {false, true}) {
                    RankDetector detector(transport, small());
                    if (warm) detector.find(piece.local());
                    const std::string name(phase_name(static_cast<Phase>(phase)));
                    detector.set_hook([&](Phase now) {
                        if (rank == failing && now == static_cast<Phase>(phase))
                            throw Error(ErrorCode::invalid_argument, "fault in " + name, Element::option);
                    });
                    const Seen seen = seen_by([&] { detector.find(piece.local()); });
                    detector.set_hook({});
                    // In the second call no triangle has changed, so centres are not recomputed: that phase is skipped.
                    const bool skipped = warm && static_cast<Phase>(phase) == Phase::place;
                    const std::string message = "rank " + std::to_string(failing) + ": fault in " + name;
                    if (seen.message != (skipped ? "" : message) || (!skipped && seen.rank != failing))
                        wrong[r] += name + ": \"" + seen.message + "\"; ";
                    if (!rows_are(detector.find(piece.local()), piece.triangle_ids, expected))
                        wrong[r] += "after " + name + "; ";
                    ++failures[r];
                }
    });
    for (std::size_t r = 0; r < ranks; ++r) {
        EXPECT_EQ(wrong[r], "") << "rank " << r;
        EXPECT_EQ(failures[r], phase_count * ranks * 2);
    }
}

TEST(RankErrors, error_names_the_first_vertex_that_is_not_finite_and_its_rank) {
    const auto spoil = [](int rank, MeshPiece& piece, IntersectionQuery&) {
        if (rank == 0) return;
        auto& xyz = std::get<0>(piece.vertices);
        xyz[3 * 5 + 1] = std::numeric_limits<float>::quiet_NaN();
        xyz[3 * 90] = std::numeric_limits<float>::infinity();
    };
    const Seen seen = seen_by_all(spoil);
    EXPECT_EQ(seen.code, ErrorCode::not_finite);
    EXPECT_EQ(seen.element, Element::vertex);
    EXPECT_EQ(seen.rank, 1);
    EXPECT_EQ(seen.message,
              "rank 1: vertex 5 is not finite (vertex " + std::to_string(seen.index) + " over all ranks)");
    const MeshPiece piece(WholeMesh(wavy_sheet<float>(16)), Distribution::blocks, 1, ranks);
    EXPECT_EQ(seen.index, piece.vertex_ids[5]);
}

TEST(RankErrors, error_about_an_index_out_of_range_names_the_rank) {
    const Seen seen = seen_by_all([](int rank, MeshPiece& piece, IntersectionQuery&) {
        if (rank == 2) piece.corners[3 * 7 + 2] = 100000;
    });
    EXPECT_EQ(seen.code, ErrorCode::index_out_of_range);
    EXPECT_EQ(seen.element, Element::triangle);
    EXPECT_EQ(seen.rank, 2);
}

TEST(RankErrors, error_names_the_missing_duplicate_or_invalid_id) {
    Seen seen = seen_by_all([](int rank, MeshPiece& piece, IntersectionQuery&) {
        if (rank == 1) piece.triangle_ids[3] = 2;
    });
    EXPECT_EQ(seen.message.substr(7), " triangle 2 is provided twice, by rank 0 and by rank 1");
    EXPECT_EQ(seen.index, 2);
    seen = seen_by_all([](int rank, MeshPiece& piece, IntersectionQuery&) {
        if (rank == 1) piece.triangle_ids[3] = 512;
    });
    EXPECT_EQ(seen.message, "rank 1: triangle 3 has the id 512, but ids are 0 to 511");
    seen = seen_by_all([](int rank, MeshPiece& piece, IntersectionQuery&) {
        if (rank == 2) piece.vertex_ids[0] = -4;
    });
    EXPECT_EQ(seen.message.substr(0, 35), "rank 2: vertex 0 has the id -4, but");
    seen = seen_by_all([](int rank, MeshPiece& piece, IntersectionQuery&) {
        if (rank == 0) piece.vertex_ids[3] = 2'000'000'000;
    });
    EXPECT_EQ(seen.message.substr(0, 56), "rank 0: there is a vertex with the id 2000000000, but al");
    seen = seen_by_all([](int, MeshPiece& piece, IntersectionQuery&) {
        for (std::int64_t& id : piece.vertex_ids) id += id >= 100;
    });
    EXPECT_EQ(seen.message.substr(7), " no rank provides vertex 100");
    EXPECT_EQ(seen.element, Element::vertex);
}

TEST(RankErrors, error_names_a_vertex_whose_coordinates_differ_between_ranks) {
    const WholeMesh mesh(wavy_sheet<float>(16));
    const MeshPiece first(mesh, Distribution::blocks, 0, ranks), second(mesh, Distribution::blocks, 1, ranks);
    std::size_t shared = 0;
    while (std::find(first.vertex_ids.begin(), first.vertex_ids.end(), second.vertex_ids[shared]) ==
           first.vertex_ids.end())
        ++shared;
    const Seen seen = seen_by_all([&](int rank, MeshPiece& piece, IntersectionQuery&) {
        float& x = std::get<0>(piece.vertices)[3 * shared];
        if (rank == 1) x = std::nextafter(x, 2.0f);
    });
    EXPECT_EQ(seen.message.substr(7), " the coordinates of vertex " + std::to_string(second.vertex_ids[shared]) +
                                          " differ between rank 0 and rank 1");
    EXPECT_EQ(seen.index, second.vertex_ids[shared]);
}

TEST(RankErrors, different_queries_or_options_on_ranks_are_an_error) {
    const std::string expected = "rank 0: the query and the options must be the same on all ranks";
    EXPECT_EQ(seen_by_all([](int rank, MeshPiece&, IntersectionQuery& query) {
                  query.output = rank == 1 ? Output::contacts : Output::pairs;
              }).message,
              expected);
    static const std::vector<GroupPair> one{{1, 2}}, other{{1, 3}};
    EXPECT_EQ(seen_by_all([](int rank, MeshPiece&, IntersectionQuery& query) {
                  query.filter.excluded_groups = rank ? one : other;
              }).message,
              expected);
    std::vector<Seen> seen(2);
    run_ranks(2, [&](Transport& transport) {
        DistributedOptions options = small();
        options.parts = 3 + transport.rank();
        RankDetector detector(transport, options);
        seen[static_cast<std::size_t>(transport.rank())] = seen_by([&] { count_pairs(detector, {}); });
    });
    EXPECT_EQ(seen[0].message, expected);
    EXPECT_EQ(seen[1], seen[0]);
    run_ranks(2, [&](Transport& transport) {
        const MeshPiece piece(WholeMesh(wavy_sheet<float>(8)), Distribution::blocks, transport.rank(), 2);
        RankDetector detector(transport, small());
        const ProximityQuery near{.radius = transport.rank() ? 0.1 : std::nextafter(0.1, 1.0)};
        seen[static_cast<std::size_t>(transport.rank())] = seen_by([&] { detector.find(piece.local(), near); });
    });
    EXPECT_EQ(seen[0].message, expected);
    EXPECT_EQ(seen[1], seen[0]);
    const Seen lonely =
        seen_by_all([](int, MeshPiece&, IntersectionQuery& query) { query.filter.groups = PairScope::between; });
    EXPECT_EQ(
        lonely.message,
        "rank 0: filter.groups = between needs groups, and no rank has any: nothing lies between different groups");
}

TEST(RankErrors, vertex_ids_missing_on_one_of_two_ranks_are_an_error) {
    std::vector<Seen> seen(2);
    run_ranks(2, [&](Transport& transport) {
        const MeshPiece piece(WholeMesh(wavy_sheet<float>(8)), Distribution::blocks, transport.rank(), 2);
        LocalMesh local = piece.local();
        if (transport.rank() == 1) local.vertex_ids = {};
        RankDetector detector(transport, small());
        seen[static_cast<std::size_t>(transport.rank())] = seen_by([&] { count_pairs(detector, local); });
    });
    EXPECT_EQ(seen[0].message, "rank 1: vertex_ids are missing on this rank, but another rank has them");
    EXPECT_EQ(seen[1], seen[0]);
}

TEST(RankErrors, invalid_options_fail_on_all_ranks) {
    for (const int which : {0, 1, 2, 3}) {
        std::vector<Seen> seen(2);
        run_ranks(2, [&](Transport& transport) {
            DistributedOptions options = small();
            if (which == 3) options.detector.method.membership = Membership::equation_5;
            if (which == 0) options.parts = -1;
            if (which == 1) options.batch_bytes = 1000;
            if (which == 2 && transport.rank() == 1) options.detector.leaf_size = 0;
            seen[static_cast<std::size_t>(transport.rank())] = seen_by([&] { RankDetector(transport, options); });
        });
        EXPECT_NE(seen[0].message, "");
        EXPECT_EQ(seen[1], seen[0]);
        EXPECT_EQ(seen[0].rank, which == 2 ? 1 : 0);
    }
}

TEST(RankErrors, stop_requested_on_one_rank_cancels_the_call_on_all_ranks) {
    const WholeMesh mesh(wavy_sheet<float>(16));
    std::vector<Seen> seen(ranks);
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::blocks, transport.rank(), ranks);
        RankDetector detector(transport, small());
        std::stop_source source;
        if (transport.rank() == 1) source.request_stop();
        seen[static_cast<std::size_t>(transport.rank())] =
            seen_by([&] { detector.find(piece.local(), IntersectionQuery(), source.get_token()); });
    });
    for (const Seen& by_one : seen) {
        EXPECT_EQ(by_one.code, ErrorCode::cancelled);
        EXPECT_EQ(by_one.message, "rank 1: the call was cancelled");
    }
}

TEST(RankErrors, hook_exception_is_rethrown_on_its_rank_and_an_error_on_the_others) {
    const WholeMesh mesh(wavy_sheet<float>(8));
    std::vector<std::string> seen(ranks);
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::blocks, transport.rank(), ranks);
        RankDetector detector(transport, small());
        detector.set_hook([&](Phase phase) {
            if (transport.rank() == 2 && phase == Phase::search) throw std::out_of_range("an interrupt");
        });
        try {
            detector.find(piece.local());
        } catch (const std::out_of_range& error) {
            seen[static_cast<std::size_t>(transport.rank())] = std::string("out_of_range: ") + error.what();
        } catch (const Error& error) {
            seen[static_cast<std::size_t>(transport.rank())] = error.what();
        }
    });
    EXPECT_EQ(seen[0], "rank 2: the call was interrupted: an interrupt");
    EXPECT_EQ(seen[1], seen[0]);
    EXPECT_EQ(seen[2], "out_of_range: an interrupt");
}

TEST(RankErrors, error_in_progress_callback_ends_the_call_on_all_ranks) {
    const WholeMesh mesh(wavy_sheet<float>(8));
    std::vector<Seen> seen(ranks);
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::blocks, transport.rank(), ranks);
        RankDetector detector(transport, small());
        detector.set_progress([&](const DistributedProgress& progress) {
            if (transport.rank() == 1 && progress.parts_done == 1)
                throw Error(ErrorCode::cancelled, "enough", Element::none);
        });
        seen[static_cast<std::size_t>(transport.rank())] = seen_by([&] { detector.find(piece.local()); });
    });
    for (const Seen& by_one : seen) {
        EXPECT_EQ(by_one.code, ErrorCode::cancelled);
        EXPECT_EQ(by_one.message, "rank 1: enough");
    }
}

TEST(RankErrors, memory_limit_error_is_the_same_on_all_ranks) {
    const WholeMesh mesh(wavy_sheet<float>(40));
    std::vector<Seen> seen(ranks);
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, Distribution::blocks, transport.rank(), ranks);
        DistributedOptions options = small();
        options.detector.memory_limit = 20000;
        RankDetector detector(transport, options);
        seen[static_cast<std::size_t>(transport.rank())] = seen_by([&] { detector.find(piece.local()); });
    });
    EXPECT_EQ(seen[0].code, ErrorCode::memory_limit);
    EXPECT_GT(seen[0].bytes_needed, 20000);
    EXPECT_EQ(seen[1], seen[0]);
    EXPECT_EQ(seen[2], seen[0]);
}

// Triangles enter and leave parts from frame to frame. The memory limit is 25 % to 41 % above what the first frame
// needs. If memory of triangles that have left a part were not released, later frames would exceed the limit.
TEST(RankErrors, memory_grows_by_less_than_half_over_300_frames_of_motion) {
    const WholeMesh mesh(wavy_sheet<float>(60));
    const auto run_frames = [&](std::int64_t limit, int frames) {
        std::vector<Seen> seen(ranks);
        run_ranks(ranks, [&](Transport& transport) {
            WholeMesh now = mesh;
            MeshPiece piece(now, Distribution::blocks, transport.rank(), ranks);
            DistributedOptions options = small();
            options.parts = 9;
            options.detector.memory_limit = limit;
            RankDetector detector(transport, options);
            detector.set_clock([] { return 0.0; });  // no part moves to another rank
            for (int f = 0; f < frames; ++f) {
                auto& xyz = std::get<std::vector<float>>(now.vertices);
                const auto& start = std::get<std::vector<float>>(mesh.vertices);
                for (std::size_t i = 0; i < xyz.size(); i += 3)
                    xyz[i] = start[i] * (1 + 0.2f * std::sin(1.5f * static_cast<float>(f)));
                piece.follow();
                Seen& mine = seen[static_cast<std::size_t>(transport.rank())];
                if (mine == Seen{}) mine = seen_by([&] { detector.find(piece.local()); });
            }
        });
        return seen[0];
    };
    std::int64_t limit = 20000;
    while (run_frames(limit, 1).code == ErrorCode::memory_limit) limit += limit / 8;
    EXPECT_EQ(run_frames(limit + limit / 4, 300), Seen{});
}

TEST(RankErrors, rank_that_throws_leaves_no_rank_waiting) {
    std::vector<Seen> seen(ranks);
    EXPECT_THROW(run_ranks(ranks,
                           [&](Transport& transport) {
                               if (transport.rank() == 1) throw std::runtime_error("gone");
                               RankDetector detector(transport, small());
                           }),
                 std::exception);
}

}  // namespace
}  // namespace crumple::test
