// Compares overlaps of bodies with brute force in rational arithmetic.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "memory_limit.h"
#include "overlaps/closed_bodies.h"
#include "rounds.h"
#include "shared_results.h"

namespace crumple {
namespace {

using test::closed_bodies;
using test::ClosedBodies;
using test::difference;

struct Setting {
    int threads;
    Simd simd;
};

class OverlapAgreement : public testing::TestWithParam<Setting> {
   protected:
    Detector detector_{Options{.backend = Backend::cpu, .threads = GetParam().threads, .simd = GetParam().simd}};
    Detector reference_{Options{.backend = Backend::reference}};
    test::SharedResults<Overlaps> expected_;
    std::array<int, 5> relations_{};

    void compare(const World& world, const OverlapQuery& query = {}) {
        const Overlaps& found = detector_.find(world, query);
        ASSERT_EQ(difference(found, expected_.next([&] { return reference_.find(world, query); })), "");
        for (const OverlapRelation relation : found.relation) ++relations_[static_cast<std::size_t>(relation)];
    }
};

TEST_P(OverlapAgreement, bodies_on_a_grid_match_brute_force) {
    for (unsigned seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 3, true, false);
        compare(bodies.view());
        if (seed % 3 == 0)
            compare(bodies.view(), {.self_overlaps = true, .gradient = true, .curves = true, .windings = true});
    }
    for (const int rows : relations_) EXPECT_GT(rows, 0);
}
TEST_P(OverlapAgreement, bodies_off_the_grid_match_brute_force) {
    for (unsigned seed = 100; seed < (thorough() ? 160u : 120u); ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 3, false, true);
        compare(bodies.view(), {.filter = {.groups = seed % 3 == 0 ? PairScope::between : PairScope::both}});
        compare(bodies.view(), {.self_overlaps = seed % 2 == 0, .gradient = true, .curves = true, .windings = true});
        compare(bodies.view(), {.self_overlaps = seed % 2 == 0,
                                .curves = true,
                                .extents = true,
                                .depths = true,
                                .directions = {{0, 0, 1}, {-1, 0.5, 2}},
                                .first_free = seed % 5 == 0,
                                .translation = true,
                                .solids = seed % 3 == 0,
                                .unions = true,
                                .regions = true});
    }
    EXPECT_GT(relations_[1], 5);
}
TEST_P(OverlapAgreement, outputs_and_minimum_volumes_in_worlds_match_brute_force) {
    ClosedBodies bodies = closed_bodies(7, 6, true, false);
    for (std::size_t b = 0; b < 6; ++b) bodies.bodies[b].world = b == 5 ? -1 : static_cast<std::int32_t>(b / 2);
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::pairs})
        for (const double least : {0.0, 0.5, 100.0}) compare(bodies.view(), {.output = output, .min_volume = least});
    compare(bodies.view(), {.min_volume = 0.5, .curves = true, .unions = true, .regions = true});
}

TEST_P(OverlapAgreement, worlds_with_an_open_body_match_brute_force) {
    for (unsigned seed = 200; seed < 210; ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = closed_bodies(seed, 4, true, false);
        bodies.soups[1].triangles.pop_back();
        bodies.shapes[1] = Shape(bodies.soups[1].view());
        for (const Output output : {Output::any, Output::any_by_world, Output::pairs})
            for (const OpenSurfaces open : {OpenSurfaces::skip, OpenSurfaces::curves})
                compare(bodies.view(), {.output = output,
                                        .open = open,
                                        .self_overlaps = seed % 2 == 0,
                                        .curves = true,
                                        .depths = true,
                                        .depth_tolerance = 1,
                                        .directions = {{1, 0, 0}},
                                        .translation = true,
                                        .unions = true,
                                        .regions = true});
    }
}

TEST_P(OverlapAgreement, tilted_common_planes_match_brute_force) {
    double area = 0;
    for (unsigned seed = 300; seed < (sanitized ? 310u : 330u); ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = closed_bodies(seed, 3, true, false);
        for (std::size_t b = 0; b < bodies.soups.size(); ++b) {
            for (auto& [x, y, z] : bodies.soups[b].vertices) {
                const double along = x + 2 * z, up = z - x + 3 * y;
                x = along, z = up;
            }
            bodies.shapes[b] = Shape(bodies.soups[b].view());
        }
        compare(bodies.view(), {.self_overlaps = true, .curves = true});
        for (const double contact : detector_.find(bodies.view(), OverlapQuery()).contact_area) area += contact;
    }
    EXPECT_GT(area, 10);
}

TEST_P(OverlapAgreement, t_junctions_with_degenerate_faces_match_brute_force) {
    for (unsigned seed = 400; seed < 420; ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = closed_bodies(seed, 2, true, false);
        for (std::size_t b = 0; b < bodies.soups.size(); ++b) {
            test::add_t_junction(bodies.soups[b]);
            bodies.shapes[b] = Shape(bodies.soups[b].view());
        }
        compare(bodies.view(), {.weld = true, .gradient = true, .curves = true, .windings = true});
    }
}

TEST(OverlapMemory, call_under_a_sufficient_limit_gives_the_same_result_within_it) {
    const ClosedBodies bodies = closed_bodies(13, 16, true, false);
    test::expect_same_under_limit(
        [&](Detector& detector) { return detector.find(bodies.view(), test::all_but_first_free); },
        [](const Overlaps& a, const Overlaps& b) { return difference(a, b); });
}

INSTANTIATE_TEST_SUITE_P(All, OverlapAgreement,
                         testing::Values(Setting{1, Simd::automatic}, Setting{3, Simd::automatic},
                                         Setting{1, Simd::scalar}));

}  // namespace
}  // namespace crumple
