// Checks that the scenes have as many collisions as they were made for.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "crumple/crumple.h"
#include "rounds.h"
#include "scenes/scenes.h"

namespace crumple {
namespace {

double pairs_per_triangle(std::string_view scene, const scenes::Parameters& parameters,
                          PairScope scope = PairScope::both) {
    const io::TriangleMesh mesh = scenes::make(scene, parameters);
    Detector detector;
    IntersectionQuery query;
    query.filter.groups = scope;
    return static_cast<double>(detector.find(mesh.view(), query).pairs.size()) /
           static_cast<double>(mesh.triangle_count());
}

TEST(SceneCollisions, flat_cloth_does_not_collide) { EXPECT_EQ(pairs_per_triangle("cloth", {.triangles = 20'000}), 0); }

TEST(SceneCollisions, folded_cloth_has_about_0_7_pairs_per_triangle) {
    EXPECT_NEAR(pairs_per_triangle("cloth", {.frame = 93}), 63'602.0 / 92'230, 0.15);
}

TEST(SceneCollisions, cloth_does_not_touch_its_ball_in_four_frames) {
    for (int frame = 0; frame < 94; frame += 31) {
        EXPECT_EQ(pairs_per_triangle("cloth", {.triangles = 30'000, .frame = frame}, PairScope::between), 0) << frame;
    }
}

TEST(SceneCollisions, cloth_collides_more_every_ten_frames_from_43_to_93) {
    double last = 0;
    for (int frame = 43; frame < 94; frame += 10) {
        const double now = pairs_per_triangle("cloth", {.triangles = 30'000, .frame = frame});
        EXPECT_GT(now, last) << "frame " << frame;
        last = now;
    }
}

TEST(SceneCollisions, pairs_per_triangle_depend_little_on_the_resolution) {
    if (sanitized) GTEST_SKIP() << "what a scene is like is no matter of memory";
    for (const char* name : {"cloth", "soup", "five_decades", "bodies", "lattice"}) {
        const int frame = std::string_view(name) == "cloth" ? 93 : 0;
        const double coarse = pairs_per_triangle(name, {.triangles = 60'000, .frame = frame});
        const double fine = pairs_per_triangle(name, {.triangles = 400'000, .frame = frame});
        EXPECT_GT(coarse, 0) << name;
        EXPECT_NEAR(fine / coarse, 1, 0.25) << name;
    }
}

TEST(SceneCollisions, bodies_collide_and_knots_also_self_collide) {
    EXPECT_EQ(pairs_per_triangle("bodies", {}, PairScope::within), 0);
    EXPECT_GT(pairs_per_triangle("bodies", {}, PairScope::between), 0.05);
    EXPECT_GT(pairs_per_triangle("knots", {}, PairScope::within), 0.02);
    EXPECT_GT(pairs_per_triangle("knots", {}, PairScope::between), 0.05);
    const double model = pairs_per_triangle("model", {});
    EXPECT_GT(model, 0.001);
    EXPECT_LT(model, 0.1);
}

TEST(SceneCollisions, shells_do_not_collide) { EXPECT_EQ(pairs_per_triangle("shells", {.triangles = 10'000}), 0); }

TEST(SceneCollisions, scene_ground_has_pairs_with_the_ground_and_none_of_cloth_and_ball) {
    const io::TriangleMesh mesh = scenes::make("ground", {.triangles = 30'000, .frame = 93});
    Detector detector;
    IntersectionQuery query;
    query.filter.groups = PairScope::between;
    const Intersections& found = detector.find(mesh.view(), query);
    const auto ground = static_cast<std::int32_t>(mesh.triangle_count() - 2);
    EXPECT_GT(found.pairs.size(), 100u);
    for (const Pair pair : found.pairs) EXPECT_GE(pair.b, ground) << "pair " << pair.a << ", " << pair.b;
}

}  // namespace
}  // namespace crumple
