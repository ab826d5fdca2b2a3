// Compares distances of bodies with brute force in rational arithmetic.

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "distances/compare_nearest.h"
#include "rounds.h"
#include "shared_results.h"
#include "worlds/random_worlds.h"

namespace crumple {
namespace {

using test::Dice;
using test::random_world;
using test::same_nearest;

DistanceQuery random_nearest(unsigned seed, int bodies) {
    Dice dice(seed);
    DistanceQuery query;
    if (dice.chance(0.4)) query.radius = dice.chance(0.2) ? 0 : dice.between(0, 0.5);
    if (dice.chance(0.2)) query.filter.bodies = PairScope::between;
    query.filter.groups = static_cast<PairScope>(dice.chance(0.5) ? 0 : dice.below(3));
    for (int i = dice.below(3); i > 0 && bodies > 0; --i)
        query.filter.excluded_bodies.push_back({dice.below(bodies), dice.below(bodies)});
    for (int i = dice.below(3); i > 0; --i) query.filter.excluded_groups.push_back({dice.below(3), dice.below(3)});
    return query;
}

class NearestAgreement : public testing::TestWithParam<int> {
   protected:
    Detector detector_{Options{.backend = Backend::cpu, .threads = GetParam()}};
    Detector reference_{Options{.backend = Backend::reference}};
    test::SharedResults<Distances> expected_;

    /// Returns the result of the tested detector, and expects the same of brute force.
    const Distances& agreed(const World& world, const DistanceQuery& query) {
        const Distances& found = detector_.find(world, query);
        EXPECT_TRUE(same_nearest(found, expected_.next([&] { return reference_.find(world, query); })));
        return found;
    }

    void compare(unsigned seed, const test::WorldKind& kind) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const auto world = random_world(seed, kind);
        DistanceQuery query = random_nearest(7 * seed, kind.bodies);
        // New names for each seed, since the detector caches shapes by name.
        for (Shape& shape : world->shapes)
            if (shape.name != 0) shape.name += 1000 * (seed + 1);
        const Distances& found = agreed(world->view(), query);
        ASSERT_EQ(found.any, !found.bodies.empty());
        ASSERT_EQ(found.count, static_cast<std::int64_t>(found.bodies.size()));
        rows_ += found.bodies.size();
        for (const std::uint8_t touches : found.touching) touching_ += touches;
        query.output = Output::nearest;
        agreed(world->view(), query);
    }

    std::size_t rows_ = 0, touching_ = 0;
};

TEST_P(NearestAgreement, bodies_apart_match_brute_force) {
    for (unsigned seed = 0; seed < 25; ++seed) compare(seed, {.triangles = 12, .reach = 4});
    EXPECT_GT(rows_ - touching_, 50u);
}
TEST_P(NearestAgreement, bodies_at_one_place_match_brute_force) {
    for (unsigned seed = 100; seed < 125; ++seed) compare(seed, {.bodies = 7, .triangles = 14, .reach = 0.1});
    EXPECT_GT(touching_, 30u);
}
TEST_P(NearestAgreement, several_worlds_match_brute_force) {
    for (unsigned seed = 200; seed < 215; ++seed)
        compare(seed, {.bodies = 9, .worlds = 4, .triangles = 6, .everywhere = 0.3, .reach = 2});
}
TEST_P(NearestAgreement, larger_bodies_match_brute_force) {
    for (unsigned seed = 300; seed < 304; ++seed)
        compare(seed, {.shapes = 2, .bodies = 3, .triangles = 60, .named = 1, .reach = 3});
}
/// Many triangles intersect. The result is the first intersecting pair in the order of triangles, which is seldom the
/// pair that the search finds first.
TEST_P(NearestAgreement, larger_bodies_at_one_place_match_brute_force) {
    for (unsigned seed = 350; seed < (sanitized ? 352u : 358u); ++seed)
        compare(seed, {.shapes = 2, .bodies = 4, .triangles = 60, .named = 1, .everywhere = 0, .reach = 0.1});
    EXPECT_GE(touching_, sanitized ? 1u : 5u);
}
TEST_P(NearestAgreement, single_triangles_match_brute_force) {
    for (unsigned seed = 400; seed < 440; ++seed) compare(seed, {.shapes = 5, .triangles = 1, .reach = 1.5});
}
TEST_P(NearestAgreement, worlds_without_bodies_match_brute_force) { compare(500, {.bodies = 0}); }

/// Returns the surface of the unit cube; each face consists of cuts × cuts squares, each square of two triangles.
test::Soup<double> box(int cuts) {
    test::Soup<double> soup;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double side : {0.0, 1.0})
            for (int i = 0; i < cuts; ++i)
                for (int j = 0; j < cuts; ++j) {
                    const auto first = static_cast<std::int32_t>(soup.vertices.size());
                    for (int k = 0; k < 4; ++k) {
                        std::array<double, 3> p{};
                        p[axis] = side;
                        p[(axis + 1) % 3] = static_cast<double>(i + (k & 1)) / cuts;
                        p[(axis + 2) % 3] = static_cast<double>(j + (k >> 1)) / cuts;
                        soup.vertices.push_back(p);
                    }
                    soup.triangles.push_back({first, first + 1, first + 2});
                    soup.triangles.push_back({first + 3, first + 1, first + 2});
                }
    return soup;
}

/// Boxes with many ties, from parallel faces, parallel edges and corners, axis-aligned and turned.
TEST_P(NearestAgreement, symmetric_shapes_match_brute_force) {
    const auto coarse = box(1), fine = box(2);
    const std::vector<Shape> shapes{Shape(coarse.view(), 1), Shape(fine.view())};
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    Dice dice(3);
    for (const std::array<double, 3>& step : std::vector<std::array<double, 3>>{
             {3, 0, 0}, {1.25, 0.5, 0}, {2, 2, 0}, {2, 2, 2}, {-1.5, 0.25, 0.25}, {0, 1, 0}, {1, 1, 1}, {0.5, 0, 0}}) {
        for (const bool turned : {false, true}) {
            const Pose turn = turned ? test::random_motion(dice, 1) : Pose{};
            Pose moved = turn;
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t k = 0; k < 3; ++k) moved.rows[4 * i + 3] += turn.rows[4 * i + k] * step[k];
            const Pose poses[]{turn, moved};
            SCOPED_TRACE(testing::Message() << step[0] << ' ' << step[1] << ' ' << step[2] << " turned " << turned);
            const World world{shapes, bodies, poses};
            agreed(world, DistanceQuery());
        }
    }
}

/// Uses sizes across the range of float64, among them sizes whose squares underflow or overflow.
TEST_P(NearestAgreement, huge_and_tiny_bodies_match_brute_force) {
    for (const double size : {0x1p-1060, 0x1p-600, 0x1p-300, 0x1p250, 0x1p500, 0x1p1020}) {
        const std::vector<std::array<double, 3>> vertices{{-size, -size, 0}, {size, -size, 0}, {0, size, 0},
                                                          {-size, 0, -size}, {size, 0, size},  {0, 0, size}};
        const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
        const Shape shapes[] = {Shape(MeshView(vertices, triangles))};
        const Body bodies[] = {{}, {}, {}};
        const auto at = [&](double x) {
            Pose pose;
            pose.rows[3] = x * size;
            return pose;
        };
        const Pose poses[] = {at(0), at(2.5), at(-7)};
        const World world{shapes, bodies, poses};
        SCOPED_TRACE(size);
        agreed(world, DistanceQuery());
        for (const double radius : {0.25, 0.5, 1.0}) {
            const DistanceQuery query{.radius = radius * size};
            agreed(world, query);
        }
        // Squared distances that underflow to 0 are equal.
        const DistanceQuery nearest{.output = Output::nearest};
        agreed(world, nearest);
    }
}

INSTANTIATE_TEST_SUITE_P(Threads, NearestAgreement, testing::Values(1, 3));

}  // namespace
}  // namespace crumple
