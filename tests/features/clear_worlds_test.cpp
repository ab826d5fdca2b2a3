// Compares worlds of named bodies with brute force. Many of these worlds are "clear": their bodies are so far apart
// that the search leaves the world out, which brute force does not do.

#include <gtest/gtest.h>

#include <algorithm>

#include "crumple/crumple.h"
#include "features/compare_features.h"
#include "rounds.h"
#include "search/clear_worlds.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

/// Random world of named bodies that move a little. Of nine seeds, those above 2: without pairs within bodies and
/// groups of triangles, so that parts of bodies suffice; those above 5: most shapes list points or edges, or consist of
/// them alone.
struct Moving {
    std::unique_ptr<RandomWorld> random;
    std::vector<Pose> end;
    std::vector<std::vector<Edge>> edges;
    std::vector<std::vector<std::int32_t>> points;

    Moving(unsigned seed, const WorldKind& kind) : random(random_world(seed, kind)), end(random->poses) {
        Dice dice(seed + 1000);
        const unsigned kind_of_body = seed % 9;
        for (Body& body : random->bodies) body.self = kind_of_body <= 2 && dice.chance(0.1);
        for (Shape& shape : random->shapes) {
            shape.name += 100 * seed;
            if (kind_of_body > 2) shape.groups = {};
            if (kind_of_body > 5) add_lists(shape, dice);
        }
        for (Pose& pose : end) {
            const double step = dice.chance(0.2) ? 4 : 0.1;
            for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] += dice.between(-step, step);
        }
    }
    World view() const { return {random->shapes, random->bodies, random->poses, end}; }

   private:
    void add_lists(Shape& shape, Dice& dice) {
        const auto n = static_cast<int>(shape.vertices.rows);
        if (n < 2) return;
        if (dice.chance(0.5)) {
            std::vector<Edge>& list = edges.emplace_back();
            for (int i = dice.below(n); i > 0; --i) {
                const auto* corners = static_cast<const std::int32_t*>(shape.triangles.data);
                const int side = 3 * dice.below(static_cast<int>(shape.triangles.rows));
                const bool of_triangle = dice.chance(0.5);
                const std::int32_t a = of_triangle ? corners[side] : dice.below(n),
                                   b = of_triangle ? corners[side + 1] : dice.below(n);
                if (a != b) list.push_back({a, b});
            }
            shape.edges = list;
        }
        if (dice.chance(0.5)) {
            std::vector<std::int32_t>& list = points.emplace_back();
            for (int i = dice.below(n); i > 0; --i) list.push_back(dice.below(n));
            shape.points = list;
        }
        if (dice.chance(0.4)) shape.triangles.rows = 0;
    }
};

template <class Query>
void expect_same(Detector& detector, Detector& brute, const World& world, Query query, std::size_t& hits,
                 std::size_t& clear) {
    query.output = Output::any_by_world;
    const auto& found = detector.find(world, query).world_hit;
    const auto& expected = brute.find(world, query).world_hit;
    ASSERT_TRUE(std::ranges::equal(found, expected));
    const auto hit = static_cast<std::size_t>(std::ranges::count(expected, 1));
    hits += hit;
    clear += expected.size() - hit;
    ASSERT_EQ(detector.any(world, query), brute.any(world, query));
    query.output = Output::pairs;
    ASSERT_TRUE(same_features(detector.find(world, query), brute.find(world, query)));
    if constexpr (std::is_same_v<Query, ImpactQuery>) {
        query.output = Output::first;
        ASSERT_TRUE(same_features(detector.find(world, query), brute.find(world, query)));
    }
}

TEST(ClearWorlds, results_about_hit_and_clear_worlds_match_brute_force) {
    Detector detector({.backend = Backend::cpu}), brute({.backend = Backend::reference});
    std::size_t hits = 0, clear = 0;
    const auto seeds = static_cast<unsigned>(std::max(5, scaled_rounds(5)));
    for (unsigned seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        const Moving moving(seed,
                            {.bodies = 18, .worlds = 6, .triangles = 10, .named = 1, .everywhere = 0.1, .reach = 3});
        for (const double distance : {0.0, 0.5}) {
            ASSERT_NO_FATAL_FAILURE(
                expect_same(detector, brute, moving.view(), ImpactQuery{.min_distance = distance}, hits, clear));
            ASSERT_NO_FATAL_FAILURE(
                expect_same(detector, brute, moving.view(), ProximityQuery{.radius = distance}, hits, clear));
        }
        ProximityQuery welded{.radius = 0.2};
        welded.weld = true;
        ASSERT_NO_FATAL_FAILURE(expect_same(detector, brute, moving.view(), welded, hits, clear));
        for (const double distance : {0.0, 0.5})
            ASSERT_NO_FATAL_FAILURE(expect_same(detector, brute, moving.view(),
                                                ImpactQuery{.min_distance = distance, .approaching_only = true}, hits,
                                                clear));
        ImpactQuery filtered{.min_distance = 0.5, .triangle_pairs = true};
        filtered.filter.bodies = PairScope::between;
        filtered.filter.excluded_bodies = {{0, 1}, {2, 5}};
        ASSERT_NO_FATAL_FAILURE(expect_same(detector, brute, moving.view(), filtered, hits, clear));
    }
    EXPECT_GT(hits, 50u);
    EXPECT_GT(clear, 50u);
}

TEST(ClearWorlds, results_about_700_worlds_on_two_threads_match_brute_force) {
    Detector detector({.backend = Backend::cpu, .threads = 2}), brute({.backend = Backend::reference});
    std::size_t hits = 0, clear = 0;
    for (const unsigned seed : {4u, 8u}) {
        SCOPED_TRACE(seed);
        const Moving moving(
            seed, {.bodies = 1400, .worlds = 700, .triangles = 3, .named = 1, .everywhere = 0.002, .reach = 1});
        ASSERT_NO_FATAL_FAILURE(
            expect_same(detector, brute, moving.view(), ProximityQuery{.radius = 0.05}, hits, clear));
        ASSERT_NO_FATAL_FAILURE(
            expect_same(detector, brute, moving.view(), ImpactQuery{.min_distance = 0.05}, hits, clear));
    }
    EXPECT_GT(hits, 50u);
    EXPECT_GT(clear, 50u);
}

TEST(ClearWorlds, shape_of_another_size_under_a_used_name_is_an_error_with_or_without_lists) {
    const std::vector<std::array<double, 3>> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::array<std::int32_t, 3>> one{{0, 1, 2}}, two{{0, 1, 2}, {1, 2, 0}};
    const std::vector<std::int32_t> points{0, 1};
    Detector detector;
    const auto find = [&](const std::vector<std::array<std::int32_t, 3>>& triangles, bool lists) {
        std::vector<Shape> shapes{Shape{MeshView(vertices, triangles), 7}, Shape{MeshView(vertices, one), 8}};
        if (lists) shapes[0].points = points;
        const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
        std::vector<Pose> poses(2);
        poses[1].rows[11] = 9;
        return detector.find(World{shapes, bodies, poses}, ProximityQuery{.radius = 1}).edges.size();
    };
    EXPECT_EQ(find(one, true), 6u);
    EXPECT_EQ(find(one, false), 6u);
    EXPECT_THROW(find(two, false), Error);
    EXPECT_EQ(find(one, false), 6u);
    EXPECT_THROW(find(two, true), Error);
}

TEST(ClearWorlds, vertex_posed_beyond_float32_is_an_error) {
    const std::vector<std::array<float, 3>> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}};
    const std::vector<Shape> shapes{Shape{MeshView(vertices, triangles), 7}};
    const std::vector<Body> bodies(2);
    std::vector<Pose> poses(2);
    poses[1].rows[3] = 1e39;
    EXPECT_THROW(Detector().any(World{shapes, bodies, poses}, ProximityQuery{.radius = 1}), Error);
}

TEST(ClearWorlds, trees_decide_most_worlds) {
    using Verdict = ClearWorlds::Verdict;
    MemoryMeter meter;
    Cancellation cancellation;
    std::array<int, 3> counts{};
    for (unsigned seed = 3; seed < 20; ++seed) {
        const Moving moving(seed,
                            {.bodies = 24, .worlds = 6, .triangles = 12, .named = 1, .everywhere = 0, .reach = 3});
        WorldOutline outline(&meter);
        outline.read(moving.view(), {});
        BodyFilter filter(&meter);
        filter.prepare({});
        ShapeTrees trees(meter);
        ClearWorlds worlds(meter, cancellation, trees);
        worlds.read(outline, filter, false, 0.7, true);
        ParallelFor one_thread;
        worlds.decide(one_thread, 0, outline.worlds() + 1, false);
        for (std::int32_t w = 0; w < outline.worlds(); ++w) ++counts[static_cast<std::size_t>(worlds.verdict(w))];
    }
    EXPECT_GT(counts[static_cast<std::size_t>(Verdict::clear)], 10);
    EXPECT_GT(counts[static_cast<std::size_t>(Verdict::hit)], 10);
    EXPECT_GT(counts[static_cast<std::size_t>(Verdict::clear)] + counts[static_cast<std::size_t>(Verdict::hit)],
              4 * counts[static_cast<std::size_t>(Verdict::search)]);
}

TEST(ClearWorlds, release_frees_all_memory) {
    const Moving moving(3, {.shapes = 2, .bodies = 40, .worlds = 5, .named = 1});
    MemoryMeter meter;
    WorldOutline outline(&meter);
    outline.read(moving.view(), {});
    BodyFilter filter(&meter);
    filter.prepare({});
    ShapeTrees trees(meter);
    Cancellation cancellation;
    ClearWorlds worlds(meter, cancellation, trees);
    const std::int64_t before = meter.used;
    worlds.read(outline, filter, false, 1, true);
    ParallelFor one_thread;
    worlds.decide(one_thread, 0, outline.worlds() + 1, false);
    trees.release();
    EXPECT_GT(meter.used, before);
    worlds.release();
    EXPECT_EQ(meter.used, before);
}

/// Uses a body that is 2 above an equal body.
TEST(ClearWorlds, bodies_at_exactly_the_query_distance_count_as_hits) {
    const std::vector<std::array<double, 3>> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}};
    Shape shape{MeshView(vertices, triangles), 7};
    const std::vector<Shape> shapes{shape};
    const std::vector<Body> bodies(2);
    std::vector<Pose> start(2), end(2);
    start[1].rows[11] = end[1].rows[11] = 2;
    Detector detector;
    const auto near = [&](double distance) {
        return std::pair(detector.any(World{shapes, bodies, start}, ProximityQuery{.radius = distance}),
                         detector.any(World{shapes, bodies, start, end}, ImpactQuery{.min_distance = distance}));
    };
    EXPECT_EQ(near(2), std::pair(true, true));
    EXPECT_EQ(near(std::nextafter(2., 0.)), std::pair(false, false));
    end[1].rows[11] = 1;
    EXPECT_EQ(near(1), std::pair(false, true));
    end[1].rows[11] = -1;
    EXPECT_EQ(near(0), std::pair(false, true)) << "on the way";
    start[1].rows[3] = 1e308, end[1].rows[3] = 1e308;
    EXPECT_FALSE(detector.any(World{shapes, bodies, start, end}, ImpactQuery()));
    end[1].rows[0] = 1e308, end[1].rows[3] = 1.7e308;
    try {
        detector.any(World{shapes, bodies, start, end}, ImpactQuery());
        FAIL() << "a vertex is posed to infinity";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::not_finite);
    }
}

}  // namespace
}  // namespace crumple::test
