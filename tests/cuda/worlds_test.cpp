// Tests of worlds searched side by side: in one pass, which runs all stages over the leaves of all worlds.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "agreement/hard_soups.h"
#include "worlds/compare_worlds.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

/// Two worlds have the same bodies. The first hit decides the first world. In the second world the pair filter excludes
/// all pairs.
TEST(CudaWorlds, decided_worlds_are_not_searched_further) {
    const auto a = random_soup<float>(1500, 0.1, 3), b = random_soup<float>(1500, 0.1, 4);
    auto c = a, d = b;
    c.groups.assign(1500, 1);
    d.groups.assign(1500, 2);
    const std::vector<Shape> shapes{Shape(a.view()), Shape(b.view()), Shape(c.view()), Shape(d.view())};
    std::vector<Body> bodies;
    for (int i = 0; i < 4; ++i) bodies.push_back({.shape = i, .world = i / 2});
    IntersectionQuery query;
    query.filter.excluded_groups.push_back({1, 2});
    Detector detector({.backend = Backend::cuda});
    const Intersections all = detector.find(World{shapes, bodies, {}}, query);
    query.output = Output::any_by_world;
    const Intersections& flags = detector.find(World{shapes, bodies, {}}, query);
    ASSERT_GT(all.world_counts[0], 100);
    ASSERT_EQ(all.world_counts[1], 0);
    EXPECT_TRUE(same_bytes(flags.world_hit, all.world_hit, "flags of worlds"));
    // Each world has half of the overlaps. The first round sweeps a sixteenth of both worlds, the second round all of
    // the world that is still undecided.
    EXPECT_GT(flags.statistics.box_overlaps, all.statistics.box_overlaps * 2 / 5);
    EXPECT_LT(flags.statistics.box_overlaps, all.statistics.box_overlaps * 2 / 3);
}

/// In every other world a corner lies in the plane of the other triangle. The device cannot decide that, as products of
/// subnormal numbers underflow.
TEST(CudaWorlds, worlds_that_only_the_host_can_decide_have_correct_flags) {
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
    const auto two = [](double height) {
        std::vector<std::array<double, 3>> corners{{-4, -4, 0},    {4, -4, 0}, {0, 4, 0},
                                                   {0, 0, height}, {4, 0, 4},  {0, 4, 4}};
        for (auto& corner : corners)
            for (double& x : corner) x *= 0x1p-1074;
        return corners;
    };
    const auto touching = two(0), apart = two(1);
    const std::vector<Shape> shapes{Shape(MeshView(touching, triangles)), Shape(MeshView(apart, triangles))};
    std::vector<Body> bodies;
    for (int w = 0; w < 7; ++w) bodies.push_back({.shape = w % 2, .world = w, .self = true});
    const Intersections found =
        Detector({.backend = Backend::cuda}).find(World{shapes, bodies, {}}, {.output = Output::any_by_world});
    EXPECT_EQ(std::vector<int>(found.world_hit.begin(), found.world_hit.end()), (std::vector{1, 0, 1, 0, 1, 0, 1}));
    EXPECT_GT(found.statistics.rational_tests, 0);
}

/// All soups are at the origin. Some are so large that others are tiny compared with them.
TEST(CudaWorlds, hard_soups_match_the_cpu) {
    const std::vector<NamedMesh> soups = hard_soups();
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    for (const NamedMesh& soup : soups) {
        const auto number = static_cast<std::int32_t>(shapes.size());
        shapes.push_back(Shape(soup.mesh.view()));
        bodies.push_back({.shape = number, .world = number, .self = true});
    }
    for (const int leaf_size : {3000, 40}) {
        Detector cuda({.backend = Backend::cuda, .leaf_size = leaf_size}), cpu({.backend = Backend::cpu});
        for (const Output output : {Output::any_by_world, Output::contacts, Output::any_by_world})
            for (const bool weld : {false, true}) {
                SCOPED_TRACE(testing::Message() << "leaves of " << leaf_size << ", wants " << static_cast<int>(output)
                                                << ", weld " << weld);
                const IntersectionQuery query{.output = output, .weld = weld};
                const World world{shapes, bodies, {}};
                EXPECT_TRUE(same_world_result(cuda.find(world, query), cpu.find(world, query)));
            }
    }
}

/// Small worlds are searched side by side. A world that is large enough to fill a device is searched alone, after the
/// worlds before it and before those after it.
TEST(CudaWorlds, large_world_among_small_ones_matches_the_cpu) {
    const auto large = random_soup<float>(70'000, 0.004, 5);
    const auto first = random_soup<float>(60, 0.3, 1), second = random_soup<float>(45, 0.3, 2);
    const std::vector<Shape> shapes{Shape(first.view()), Shape(second.view()), Shape(large.view())};
    std::vector<Body> bodies;
    for (int w = 0; w < 6; ++w)
        for (int b = 0; b < 2; ++b) bodies.push_back({.shape = w == 2 && b == 0 ? 2 : b, .world = w, .self = true});
    const World world{shapes, bodies, {}};
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const Intersections& found = cuda.find(world);
    EXPECT_TRUE(same_world_result(found, cpu.find(world)));
    EXPECT_LT(found.statistics.leaves, 80) << "small worlds are a leaf each";
}

}  // namespace
}  // namespace crumple::test
