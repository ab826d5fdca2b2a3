// Compares worlds with brute force in rational arithmetic.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tested_backend.h"
#include "worlds/compare_worlds.h"
#include "worlds/random_worlds.h"

namespace crumple {
namespace {

using test::random_query;
using test::random_world;
using test::same_world_result;

const unsigned seeds = test::played ? 4 : 40;

class Worlds : public testing::TestWithParam<Backend> {
   protected:
    Detector detector_{Options{.backend = GetParam(), .threads = 2}};
    Detector reference_{Options{.backend = Backend::reference}};

    void compare(unsigned seed, const test::WorldKind& kind) { compare(detector_, seed, kind); }
    void compare(Detector& detector, unsigned seed, const test::WorldKind& kind) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const auto world = random_world(seed, kind);
        for (unsigned i = 0; i < 3; ++i) {
            const IntersectionQuery query = random_query(7 * seed + i, kind.bodies);
            SCOPED_TRACE(testing::Message() << "question " << i << ", wants " << static_cast<int>(query.output));
            // Uses new names each time, since a detector caches named shapes.
            auto shapes = world->shapes;
            for (Shape& shape : shapes)
                if (shape.name != 0) shape.name += 1000 * (seed + 1);
            const World view{shapes, world->bodies, world->poses};
            ASSERT_TRUE(same_world_result(detector.find(view, query), reference_.find(view, query)));
        }
    }
};

TEST_P(Worlds, random_worlds_match_brute_force) {
    for (unsigned seed = 0; seed < seeds; ++seed) compare(seed, {});
}
TEST_P(Worlds, worlds_of_named_shapes_match_brute_force) {
    for (unsigned seed = 100; seed < 100 + seeds; ++seed) compare(seed, {.named = 1});
}
TEST_P(Worlds, worlds_of_unnamed_shapes_match_brute_force) {
    for (unsigned seed = 200; seed < 200 + seeds; ++seed) compare(seed, {.named = 0});
}
TEST_P(Worlds, worlds_at_one_place_match_brute_force) {
    for (unsigned seed = 300; seed < 300 + seeds; ++seed) compare(seed, {.bodies = 12, .worlds = 5});
}
TEST_P(Worlds, worlds_of_many_bodies_match_brute_force) {
    for (unsigned seed = 400; seed < 400 + seeds / 4; ++seed)
        compare(seed, {.bodies = 90, .worlds = 2, .triangles = 5, .everywhere = 0.5, .reach = 2});
}
/// Uses scenes of few and of many worlds, some of them without bodies. Their triangles form one leaf, or leaves on one
/// or two levels.
TEST_P(Worlds, scenes_of_2_to_70_worlds_match_brute_force) {
    const auto compare_many = [&](int worlds, const Options& options) {
        SCOPED_TRACE(testing::Message() << worlds << " worlds, leaves of " << options.leaf_size);
        Detector detector(options);
        compare(detector, 600 + static_cast<unsigned>(worlds),
                {.shapes = 9, .bodies = 3 * worlds, .worlds = worlds, .everywhere = 1.5 / worlds, .gaps = 0.2});
    };
    for (const int worlds : {2, 3, 9, 31, 70}) compare_many(worlds, {.backend = GetParam(), .threads = 2});
    for (const int worlds : {2, 5, 12}) {
        compare_many(worlds, {.backend = GetParam(), .threads = 2, .leaf_size = 20});
        compare_many(worlds, {.backend = GetParam(), .threads = 2, .clusters = 3, .leaf_size = 8});
    }
}
TEST_P(Worlds, worlds_without_bodies_match_brute_force) { compare(500, {.bodies = 0}); }

/// Bodies beside each other and across each other, unscaled and scaled down to small numbers.
TEST_P(Worlds, shapes_up_to_the_largest_numbers_match_brute_force) {
    const double most = std::numeric_limits<double>::max();
    for (const double size : {0x1p1021, 0x1p1022, 0x1p1023, most}) {
        const std::vector<std::array<double, 3>> vertices{{-size, -size, 0}, {size, -size, 0}, {0, size, 0},
                                                          {-size, 0, -size}, {size, 0, size},  {0, 0, size}};
        const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
        const MeshView mesh(vertices, triangles);
        for (const std::uint64_t name : {0u, 1u}) {
            const std::uint64_t unique = name ? static_cast<std::uint64_t>(std::ilogb(size)) + (size == most) : 0;
            const Shape shapes[] = {Shape(mesh, unique)};
            const Body bodies[] = {{.world = 0, .self = true}, {.world = 0, .self = true}, {.world = 0, .self = true}};
            for (const double scale : {1.0, 0x1p-1000}) {
                const auto at = [&](double x) {
                    Pose pose;
                    for (std::size_t i = 0; i < 12; i += 5) pose.rows[i] = scale;
                    pose.rows[3] = x;
                    return pose;
                };
                const Pose poses[] = {at(0), at(1e6), at(-3e7)};
                for (const Output output : {Output::any, Output::body_pairs, Output::contacts}) {
                    SCOPED_TRACE(testing::Message() << size << " named " << name << " scaled by " << scale);
                    const World world{shapes, bodies, poses};
                    const IntersectionQuery query{.output = output};
                    ASSERT_TRUE(same_world_result(detector_.find(world, query), reference_.find(world, query)));
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(, Worlds, testing::Values(test::tested_backend), test::name_of_backend);

}  // namespace
}  // namespace crumple
