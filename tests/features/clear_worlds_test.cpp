// Compares worlds of named bodies with brute force. Many of these worlds are "clear": their bodies are so far apart
// that the search leaves the world out, which brute force does not do.

#include <gtest/gtest.h>

#include <algorithm>

#include "crumple/crumple.h"
#include "search/clear_worlds.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

struct Moving {
    std::unique_ptr<RandomWorld> random;
    std::vector<Pose> end;

    Moving(unsigned seed, const WorldKind& kind) : random(random_world(seed, kind)), end(random->poses) {
        Dice dice(seed + 1000);
        for (Body& body : random->bodies) body.self = dice.chance(0.1);
        for (Shape& shape : random->shapes) shape.name += 100 * seed;
        for (Pose& pose : end) {
            const double step = dice.chance(0.2) ? 4 : 0.1;
            for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] += dice.between(-step, step);
        }
    }
    World view() const { return {random->shapes, random->bodies, random->poses, end}; }
};

template <class Query>
void expect_same_hits(Detector& detector, Detector& brute, const World& world, Query query, std::size_t& hits,
                      std::size_t& clear) {
    query.output = Output::any_by_world;
    const auto& found = detector.find(world, query).world_hit;
    const auto& expected = brute.find(world, query).world_hit;
    ASSERT_TRUE(std::ranges::equal(found, expected));
    const auto hit = static_cast<std::size_t>(std::ranges::count(expected, 1));
    hits += hit;
    clear += expected.size() - hit;
    ASSERT_EQ(detector.any(world, query), brute.any(world, query));
}

TEST(ClearWorlds, hit_flags_of_hit_and_clear_worlds_match_brute_force) {
    Detector detector({.backend = Backend::cpu}), brute({.backend = Backend::reference});
    std::size_t hits = 0, clear = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        SCOPED_TRACE(seed);
        const Moving moving(seed,
                            {.bodies = 24, .worlds = 6, .triangles = 12, .named = 1, .everywhere = 0.1, .reach = 3});
        for (const double distance : {0.0, 0.2, 1.5}) {
            ASSERT_NO_FATAL_FAILURE(
                expect_same_hits(detector, brute, moving.view(), ImpactQuery{.min_distance = distance}, hits, clear));
            ASSERT_NO_FATAL_FAILURE(
                expect_same_hits(detector, brute, moving.view(), ProximityQuery{.radius = distance}, hits, clear));
        }
        ImpactQuery filtered{.min_distance = 0.5, .triangle_pairs = true};
        filtered.filter.bodies = PairScope::between;
        filtered.filter.excluded_bodies = {{0, 1}, {2, 5}};
        ASSERT_NO_FATAL_FAILURE(expect_same_hits(detector, brute, moving.view(), filtered, hits, clear));
    }
    EXPECT_GT(hits, 50u);
    EXPECT_GT(clear, 50u);
}

/// Uses a body that is 2 above an equal body.
TEST(ClearWorlds, release_frees_all_memory) {
    const Moving moving(3, {.shapes = 2, .bodies = 40, .worlds = 5, .named = 1});
    MemoryMeter meter;
    WorldOutline outline(&meter);
    outline.read(moving.view(), {});
    BodyFilter filter(&meter);
    filter.prepare({});
    ShapeTrees trees(meter);
    ClearWorlds worlds(meter, trees);
    const std::int64_t before = meter.used;
    worlds.read(outline, filter, true, 0);
    trees.release();
    EXPECT_GT(meter.used, before);
    worlds.release();
    EXPECT_EQ(meter.used, before);
}

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
