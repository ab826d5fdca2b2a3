// Compares results about bodies on many ranks with those of a single detector, byte by byte.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "distributed/rank_detector.h"
#include "distributed/rank_failures.h"
#include "distributed/rank_worlds.h"
#include "distributed/thread_ranks.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

constexpr std::array rank_counts{1, 2, 3, 5, 64};

DistributedOptions for_bodies(int parts = 0) {
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    options.parts = parts;
    return options;
}

WorldKind one_world(int bodies) {
    WorldKind kind;
    kind.bodies = bodies, kind.everywhere = 0, kind.reach = 0.3;
    return kind;
}

/// Returns a random query (see random_query) that ranks support. Changes Body::self of the world's bodies so that they
/// fit the query.
IntersectionQuery query_for_ranks(unsigned seed, RandomWorld& world) {
    IntersectionQuery query = random_query(seed, static_cast<int>(world.bodies.size()));
    query.index = false;
    if (seed % 2 == 0) query.output = Output::contacts;
    if (seed % 3 == 0) {
        query.filter.bodies = PairScope::both;
        query.filter.excluded_bodies.clear();
        for (Body& body : world.bodies) body.self = true;
    } else {
        query.filter.groups = PairScope::both;
        query.filter.excluded_groups.clear();
        if (seed % 3 == 1)
            for (Body& body : world.bodies) body.self = false;
    }
    return query;
}

/// Returns a world in which bodies 0 and 1 are boxes side by side with a common face, and the others soups that lie
/// among them.
std::unique_ptr<RandomWorld> touching_world(int soups) {
    auto world = std::make_unique<RandomWorld>();
    world->floats.reserve(2);
    Soup<float> box;
    for (int i = 0; i < 8; ++i)
        box.vertices.push_back(
            {static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2 & 1)});
    box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    world->floats.push_back(box);
    world->floats.push_back(random_soup<float>(30, 0.3));
    for (const Soup<float>& soup : world->floats) world->shapes.push_back(Shape(soup.view()));
    for (int b = 0; b < 2 + soups; ++b) {
        world->bodies.push_back({b < 2 ? 0 : 1, b, 0, b % 2 == 0});
        world->poses.push_back({});
        world->poses.back().rows[3] = b < 2 ? b : 0.3 * b;
    }
    return world;
}

testing::AssertionResult same_in_world(const World& world, Distribution how, int ranks, const IntersectionQuery& query,
                                       const DistributedOptions& options = for_bodies()) {
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Intersections expected = one.find(world, query);
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        const WorldPiece piece(world, how, transport.rank(), ranks);
        RankDetector detector(transport, options);
        verdicts.add(transport.rank(), rows_are(detector.find(piece.local(), query), piece, expected));
    });
    return verdicts.all();
}

TEST(RankBodies, intersections_match_a_single_detector) {
    std::int64_t rows = 0;
    for (unsigned seed = 1; seed <= 72; ++seed) {
        const auto world = random_world(seed, one_world(2 + static_cast<int>(seed % 9)));
        const IntersectionQuery query = query_for_ranks(seed, *world);
        Detector one({.backend = Backend::cpu, .threads = 1});
        rows += one.find(world->view(), query).count;
        const int ranks = seed % 20 == 0 ? 64 : rank_counts[seed % 4];
        ASSERT_TRUE(same_in_world(world->view(), every_distribution[seed / 4 % 4], ranks, query)) << "seed " << seed;
    }
    EXPECT_GT(rows, 1000);
}

TEST(RankBodies, every_output_matches_a_single_detector) {
    const auto world = touching_world(5);
    for (const Output output :
         {Output::any, Output::any_by_world, Output::body_pairs, Output::count, Output::pairs, Output::contacts})
        for (const int ranks : rank_counts)
            for (const bool weld : {false, true}) {
                IntersectionQuery query;
                query.output = output, query.weld = weld;
                query.filter.excluded_bodies = {{2, 1}, {0, 0}};
                ASSERT_TRUE(same_in_world(world->view(), Distribution::round_robin, ranks, query, for_bodies(7)))
                    << ranks << " ranks, wants " << static_cast<int>(output);
            }
}

TEST(RankBodies, without_ids_bodies_are_numbered_rank_by_rank) {
    const auto world = random_world(12, one_world(7));
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Intersections expected = one.find(world->view());
    ASSERT_GT(expected.count, 0);
    RankFailures verdicts;
    run_ranks(3, [&](Transport& transport) {
        const WorldPiece piece(world->view(), Distribution::blocks, transport.rank(), 3);
        LocalWorld local = piece.local();
        local.body_ids = {};
        RankDetector detector(transport, for_bodies());
        verdicts.add(transport.rank(), rows_are(detector.find(local), piece, expected));
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(RankBodies, moved_statistic_is_set_if_bodies_move_but_not_if_one_is_replaced) {
    constexpr int ranks = 3, frames = 5;
    std::vector<std::unique_ptr<RandomWorld>> worlds;
    for (int frame = 0; frame < frames; ++frame) {
        worlds.push_back(touching_world(6));
        for (std::size_t b = 0; b < worlds.back()->poses.size(); ++b)
            worlds.back()->poses[b].rows[7] += 0.02 * frame * static_cast<double>(b % 3);
    }
    RankFailures verdicts;
    run_ranks(ranks, [&](Transport& transport) {
        Detector one({.backend = Backend::cpu, .threads = 1});
        WorldPiece piece(worlds[0]->view(), Distribution::round_robin, transport.rank(), ranks);
        RankDetector detector(transport, for_bodies());
        for (int frame = 0; frame < frames; ++frame) {
            const World now = worlds[static_cast<std::size_t>(frame)]->view();
            piece.follow(now);
            const DistributedIntersections& found = detector.find(piece.local());
            verdicts.add(transport.rank(), rows_are(found, piece, one.find(now)));
            if (found.statistics.moved != (frame > 0))
                verdicts.add(transport.rank(), testing::AssertionFailure() << "moved in frame " << frame);
        }
        // Replacing a body does not count as motion.
        piece.bodies[0].shape = static_cast<std::int32_t>(piece.shapes.size()) - 1;
        if (transport.rank() == 1) piece.shapes.back() = Shape(worlds[0]->floats[0].view());
        if (detector.find(piece.local()).statistics.moved)
            verdicts.add(transport.rank(), testing::AssertionFailure() << "another body moved");
    });
    EXPECT_TRUE(verdicts.all());
}

/// Returns poses at the end of a step.
std::vector<Pose> end_poses_of(const RandomWorld& world, unsigned seed) {
    Dice dice(seed);
    std::vector<Pose> ends;
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        Pose pose = world.poses.empty() ? Pose{} : world.poses[b];
        for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] += dice.between(-0.3, 0.3);
        ends.push_back(pose);
    }
    return ends;
}

TEST(RankBodies, impacts_and_proximities_match_a_single_detector) {
    std::int64_t rows = 0;
    for (unsigned seed = 1; seed <= 24; ++seed) {
        WorldKind kind = one_world(2 + static_cast<int>(seed % 6));
        kind.triangles = 12;
        const auto random = random_world(seed, kind);
        const IntersectionQuery like = query_for_ranks(seed, *random);
        const std::vector<Pose> ends = end_poses_of(*random, seed);
        World world = random->view();
        world.end_poses = ends;
        ImpactQuery motion;
        motion.filter = like.filter, motion.weld = like.weld;
        motion.min_distance = seed % 2 ? 0.01 : 0;
        ProximityQuery near;
        near.filter = like.filter, near.weld = like.weld;
        near.radius = 0.05, near.closest = seed % 2 == 0;
        Detector one({.backend = Backend::cpu, .threads = 1});
        const Impacts impacts = one.find(world, motion);
        const Proximities nearby = one.find(world, near);
        rows += impacts.count + nearby.count;
        const int ranks = rank_counts[seed % 4];
        RankFailures verdicts;
        run_ranks(ranks, [&](Transport& transport) {
            const int rank = transport.rank();
            const WorldPiece piece(world, every_distribution[seed / 4 % 4], rank, ranks);
            RankDetector detector(transport, for_bodies(seed % 2 ? 0 : 5));
            const DistributedImpacts& found = detector.find(piece.local(), motion);
            verdicts.add(rank, feature_rows_are(found, piece, impacts));
            if (!(found.first == impacts.first)) verdicts.add(rank, testing::AssertionFailure() << "first impact");
            if (seed % 3 == 0) {
                ImpactQuery smaller = motion;
                smaller.output = Output::first;
                if (!(detector.find(piece.local(), smaller).first == impacts.first))
                    verdicts.add(rank, testing::AssertionFailure() << "earliest");
                smaller.output = Output::any;
                if (detector.find(piece.local(), smaller).any != impacts.any)
                    verdicts.add(rank, testing::AssertionFailure() << "any");
            }
            verdicts.add(rank, feature_rows_are(detector.find(piece.local(), near), piece, nearby));
        });
        ASSERT_TRUE(verdicts.all()) << "seed " << seed;
    }
    EXPECT_GT(rows, 1000);
}

// Edges are recomputed when triangles change, even if their number does not.
TEST(RankBodies, proximities_match_a_single_detector_after_corners_of_triangles_change) {
    Soup<float> fan = random_soup<float>(8, 0.5), loose = fan;
    for (std::size_t t = 1; t < fan.triangles.size(); ++t) fan.triangles[t][0] = 0, fan.triangles[t][1] = 1;
    const std::vector<Body> bodies(3, Body{.self = true});
    ProximityQuery near;
    near.radius = 0.2;
    RankFailures verdicts;
    run_ranks(2, [&](Transport& transport) {
        RankDetector detector(transport, for_bodies());
        Detector one({.backend = Backend::cpu, .threads = 1});
        for (const Soup<float>* soup : {&fan, &loose, &fan}) {
            const Shape shape(soup->view());
            const World world{{&shape, 1}, bodies, {}};
            const WorldPiece piece(world, Distribution::round_robin, transport.rank(), 2);
            verdicts.add(transport.rank(),
                         feature_rows_are(detector.find(piece.local(), near), piece, one.find(world, near)));
        }
    });
    EXPECT_TRUE(verdicts.all());
}

TEST(RankBodies, no_or_one_body_matches_a_single_detector) {
    for (const int bodies : {0, 1}) {
        const auto world = random_world(5, one_world(bodies));
        world->poses.clear();
        ASSERT_TRUE(same_in_world(world->view(), Distribution::round_robin, 3, {}));
        IntersectionQuery query;
        query.output = Output::body_pairs, query.filter.bodies = PairScope::between;
        ASSERT_TRUE(same_in_world(world->view(), Distribution::round_robin, 3, query));
    }
}

/// Makes a call on three ranks whose arguments spoil(rank, piece, share, query) has made invalid. Returns the error
/// message, or the messages of all ranks if they differ. Expects valid calls to work afterwards.
template <class Spoil>
std::string refused(Spoil spoil, ErrorCode code = ErrorCode::invalid_argument, std::int64_t index = -1) {
    const auto world = touching_world(4);
    Detector one({.backend = Backend::cpu, .threads = 1});
    const Intersections expected = one.find(world->view());
    std::vector<std::string> messages(3);
    run_ranks(3, [&](Transport& transport) {
        const auto rank = static_cast<std::size_t>(transport.rank());
        const WorldPiece good(world->view(), Distribution::round_robin, transport.rank(), 3);
        RankDetector detector(transport, for_bodies());
        for (int frame = 0; frame < 2; ++frame) {
            WorldPiece piece = good;
            LocalWorld local;
            IntersectionQuery query;
            try {
                local = piece.local();
                spoil(transport.rank(), piece, local, query);
                detector.find(local, query);
                messages[rank] = "nothing";
            } catch (const Error& error) {
                messages[rank] = error.what();
                if (error.code != code || (index >= 0 && (error.index != index || error.element != Element::body)))
                    messages[rank] += ", of another kind";
            }
            if (!rows_are(detector.find(good.local(), IntersectionQuery()), good, expected))
                messages[rank] += ", and does not go on";
        }
    });
    return messages[1] == messages[0] && messages[2] == messages[0]
               ? messages[0]
               : messages[0] + "; " + messages[1] + "; " + messages[2];
}

TEST(RankBodies, invalid_calls_fail_alike_on_all_ranks) {
    using RankMesh = LocalWorld;
    EXPECT_EQ(refused(
                  [](int rank, WorldPiece& piece, RankMesh& local, IntersectionQuery&) {
                      if (rank == 1) piece.ids[0] = 0, local = piece.local();
                  },
                  ErrorCode::invalid_argument, 0),
              "rank 0: body 0 is provided 2 times");
    EXPECT_EQ(refused(
                  [](int rank, WorldPiece& piece, RankMesh& local, IntersectionQuery&) {
                      if (rank == 0) piece.ids[0] = 1, local = piece.local();
                  },
                  ErrorCode::invalid_argument, 0),
              "rank 0: body 0 is missing: no rank provides it");
    EXPECT_EQ(refused(
                  [](int rank, WorldPiece& piece, RankMesh& local, IntersectionQuery&) {
                      if (rank == 2) piece.ids[1] = 6, local = piece.local();
                  },
                  ErrorCode::invalid_argument, 6),
              "rank 2: body 1 has the id 6, but ids are 0 to 5");
    EXPECT_EQ(refused([](int rank, WorldPiece&, RankMesh& local, IntersectionQuery&) {
                  if (rank == 2) local.body_ids = {};
              }),
              "rank 2: body_ids are missing on this rank, but another rank has them");
    EXPECT_EQ(refused([](int rank, WorldPiece&, RankMesh& local, IntersectionQuery&) {
                  if (rank == 1) local.body_ids = local.body_ids.first(1);
              }),
              "rank 1: there are 1 body ids for 2 bodies");
    EXPECT_EQ(refused(
                  [](int rank, WorldPiece& piece, RankMesh& local, IntersectionQuery&) {
                      if (rank == 1) piece.poses[1].rows[3] = 1e300, local = piece.local();
                  },
                  ErrorCode::not_finite, 4),
              "rank 1: body 1: vertex 0 is posed to infinity (body 4 over all ranks)");
    EXPECT_EQ(refused([](int rank, WorldPiece& piece, RankMesh& local, IntersectionQuery&) {
                  if (rank == 2) piece.bodies[1].world = 1, local = piece.local();
              }),
              "rank 2: body 1: its world must be 0, because all ranks share one world (body 5 over all ranks)");
    EXPECT_EQ(refused([](int rank, WorldPiece& piece, RankMesh& local, IntersectionQuery&) {
                  static const std::vector<Edge> edges{{0, 1}};
                  if (rank == 1) piece.shapes[0].edges = edges, local = piece.local();
              }),
              "rank 1: body 0: ranks do not support a shape's list of edges or points (body 1 over all ranks)");
    EXPECT_EQ(
        refused([](int, WorldPiece&, RankMesh&, IntersectionQuery& query) { query.filter.groups = PairScope::within; }),
        "rank 0: ranks support a filter of groups or a filter of bodies (including Body::self), not both");
    EXPECT_EQ(refused(
                  [](int, WorldPiece&, RankMesh&, IntersectionQuery& query) {
                      query.filter.excluded_bodies = {{0, 6}};
                  },
                  ErrorCode::invalid_argument, 6),
              "rank 0: excluded_bodies names body 6 of 6");
    EXPECT_EQ(refused([](int rank, WorldPiece&, RankMesh&, IntersectionQuery& query) {
                  if (rank == 2) query.filter.excluded_bodies = {{0, 1}};
              }),
              "rank 0: the query and the options must be the same on all ranks");
    EXPECT_EQ(refused([](int, WorldPiece&, RankMesh&, IntersectionQuery& query) { query.index = true; }),
              "rank 0: index must be false: ranks do not support offsets by body");
    EXPECT_EQ(refused([](int, WorldPiece&, RankMesh&, IntersectionQuery& query) { query.containment = true; }),
              "rank 0: containment must be false: ranks do not support it");
}

// One rank passes triangles and the others pass bodies: all ranks must report an error, and none may wait forever.
TEST(RankBodies, mesh_on_one_rank_and_bodies_on_others_are_an_error_on_all_ranks) {
    const auto world = touching_world(4);
    std::vector<std::string> messages(3);
    run_ranks(3, [&](Transport& transport) {
        const auto rank = static_cast<std::size_t>(transport.rank());
        const WorldPiece piece(world->view(), Distribution::round_robin, transport.rank(), 3);
        RankDetector detector(transport, for_bodies());
        try {
            if (rank == 1)
                detector.find(LocalMesh());
            else
                detector.find(piece.local());
        } catch (const Error& error) {
            messages[rank] = error.what();
        }
    });
    for (const std::string& one : messages)
        EXPECT_EQ(one, "rank 0: the query and the options must be the same on all ranks");
}

}  // namespace
}  // namespace crumple::test
