// Overlaps of bodies against brute force in rational arithmetic.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "rounds.h"
#include "worlds/random_worlds.h"

namespace crumple {
namespace {

using test::Dice;

/// Closed bodies: each of some tetrahedra and boxes, which may meet, on a grid or not, some of them inside out.
struct ClosedBodies {
    std::vector<test::Soup<double>> soups;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::vector<Pose> poses;

    World view() const { return {shapes, bodies, poses}; }
};

void add_tetrahedron(Dice& dice, bool grid, double size, test::Soup<double>& soup) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    for (int v = 0; v < 4; ++v) {
        auto& p = soup.vertices.emplace_back();
        for (double& x : p) x = grid ? dice.below(5) : dice.between(0, size);
    }
    const std::array<std::array<std::int32_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    for (const auto& [a, b, c] : faces) soup.triangles.push_back({first + a, first + b, first + c});
}

void add_box(Dice& dice, bool grid, double size, test::Soup<double>& soup) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = grid ? dice.below(3) : dice.between(0, size);
        high[k] = grid ? low[k] + 1 + dice.below(2) : low[k] + dice.between(0, size);
    }
    for (int v = 0; v < 8; ++v) {
        auto& p = soup.vertices.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) p[k] = v >> k & 1 ? high[k] : low[k];
    }
    const std::array<std::array<std::int32_t, 3>, 12> faces{{{0, 2, 1},
                                                             {1, 2, 3},
                                                             {4, 5, 6},
                                                             {5, 7, 6},
                                                             {0, 1, 4},
                                                             {1, 5, 4},
                                                             {2, 6, 3},
                                                             {3, 6, 7},
                                                             {0, 4, 2},
                                                             {2, 4, 6},
                                                             {1, 3, 5},
                                                             {3, 7, 5}}};
    for (const auto& [a, b, c] : faces) soup.triangles.push_back({first + a, first + b, first + c});
}

ClosedBodies closed_bodies(unsigned seed, int bodies, bool grid, bool posed) {
    Dice dice(seed);
    ClosedBodies all;
    all.soups.resize(static_cast<std::size_t>(bodies));
    for (auto& soup : all.soups)
        for (int part = 1 + dice.below(2); part > 0; --part)
            dice.chance(0.5) ? add_box(dice, grid, 2, soup) : add_tetrahedron(dice, grid, 3, soup);
    if (dice.chance(0.2)) all.soups[1] = all.soups[0];
    for (int b = 0; b < bodies; ++b) {
        all.shapes.emplace_back(all.soups[static_cast<std::size_t>(b)].view());
        all.bodies.push_back({.shape = b, .group = dice.below(2), .self = true});
        all.poses.push_back(posed ? test::random_pose(dice, 0.5) : Pose{});
    }
    return all;
}

/// The first array in which two results differ, by its bytes; empty if none does.
std::string difference(const Overlaps& x, const Overlaps& y) {
    const auto differ = [](const auto& a, const auto& b) {
        return a.size() != b.size() || (!a.empty() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) != 0);
    };
    if (x.any != y.any) return "any";
    if (x.count != y.count) return "count";
    if (differ(x.world_hit, y.world_hit)) return "world_hit";
    if (differ(x.bodies, y.bodies)) return "bodies";
    if (differ(x.relation, y.relation)) return "relation";
    if (differ(x.volume, y.volume)) return "volume";
    if (differ(x.centroid, y.centroid)) return "centroid";
    if (differ(x.area_vector, y.area_vector)) return "area_vector";
    if (differ(x.normal, y.normal)) return "normal";
    if (differ(x.mean_depth, y.mean_depth)) return "mean_depth";
    if (differ(x.torque, y.torque)) return "torque";
    if (differ(x.torque_point, y.torque_point)) return "torque_point";
    if (differ(x.gradient_offsets, y.gradient_offsets)) return "gradient_offsets";
    if (differ(x.gradient_vertices, y.gradient_vertices)) return "gradient_vertices";
    if (differ(x.gradient, y.gradient)) return "gradient";
    if (differ(x.winding_offsets, y.winding_offsets)) return "winding_offsets";
    if (differ(x.winding_vertices, y.winding_vertices)) return "winding_vertices";
    if (differ(x.windings, y.windings)) return "windings";
    if (differ(x.body_volume, y.body_volume)) return "body_volume";
    if (differ(x.is_solid, y.is_solid)) return "is_solid";
    return {};
}

struct Setting {
    int threads;
    Simd simd;
};

class OverlapAgreement : public testing::TestWithParam<Setting> {
   protected:
    Detector detector_{Options{.backend = Backend::cpu, .threads = GetParam().threads, .simd = GetParam().simd}};
    Detector reference_{Options{.backend = Backend::reference}};
    std::array<int, 5> relations_{};

    void compare(const World& world, const OverlapQuery& query = {}) {
        const Overlaps& found = detector_.find(world, query);
        ASSERT_EQ(difference(found, reference_.find(world, query)), "");
        for (const OverlapRelation relation : found.relation) ++relations_[static_cast<std::size_t>(relation)];
    }
};

TEST_P(OverlapAgreement, of_bodies_on_a_grid) {
    for (unsigned seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 3, true, false);
        compare(bodies.view());
        if (seed % 3 == 0) compare(bodies.view(), {.self_overlaps = true, .gradient = true, .windings = true});
    }
    for (const int rows : relations_) EXPECT_GT(rows, 0);
}
TEST_P(OverlapAgreement, of_bodies_anywhere) {
    for (unsigned seed = 100; seed < (sanitized ? 120u : 130u); ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 3, false, true);
        compare(bodies.view(), {.filter = {.groups = seed % 3 == 0 ? PairScope::between : PairScope::both}});
        compare(bodies.view(), {.self_overlaps = seed % 2 == 0, .gradient = true, .windings = true});
    }
    EXPECT_GT(relations_[1], 10);
}
TEST_P(OverlapAgreement, of_worlds_and_less_output) {
    ClosedBodies bodies = closed_bodies(7, 6, true, false);
    for (std::size_t b = 0; b < 6; ++b) bodies.bodies[b].world = b == 5 ? -1 : static_cast<std::int32_t>(b / 2);
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::pairs})
        for (const double least : {0.0, 0.5, 100.0}) compare(bodies.view(), {.output = output, .min_volume = least});
}

INSTANTIATE_TEST_SUITE_P(All, OverlapAgreement,
                         testing::Values(Setting{1, Simd::automatic}, Setting{3, Simd::automatic},
                                         Setting{1, Simd::scalar}));

}  // namespace
}  // namespace crumple
