#pragma once

// Scenes for the tests of the stages, the exact truth about them, and the fixture.

#include <gtest/gtest.h>

#include <memory>

#include "geometry/exact.h"
#include "questions/intersect/rational_intersection.h"
#include "soups.h"
#include "stages/state.h"

namespace crumple::test {

/// A scene, and which of its pairs have a point in common.
class StageCase {
   public:
    std::string name;
    Scene scene;

    template <class Scalar>
    StageCase(std::string what, Soup<Scalar> first, Soup<Scalar> second = {})
        : name(std::move(what)),
          soups_(std::make_shared<std::pair<Soup<Scalar>, Soup<Scalar>>>(std::move(first), std::move(second))) {
        const auto& [a, b] = *std::static_pointer_cast<std::pair<Soup<Scalar>, Soup<Scalar>>>(soups_);
        ParallelFor serial;
        const MeshView first_view = a.view(), second_view = b.view();
        scene = prepare_scene(first_view, b.triangles.empty() ? nullptr : &second_view, false, serial, *buffers_);
        for (std::int32_t i = 0; i < scene.triangle_count(); ++i)
            for (std::int32_t j = i + 1; j < scene.triangle_count(); ++j) {
                if (scene.between && scene.second(i) == scene.second(j)) continue;
                const RationalIntersection exact = intersect_rationally(scene.triangle(i), scene.triangle(j));
                if (!exact.points.empty()) meeting_.push_back({i, j});
                if (collide(exact, Neighbours::geometric, Intersections::all)) colliding_.push_back({i, j});
            }
    }

    /// Those that a search must not lose, sorted.
    const std::vector<Pair>& meeting() const { return meeting_; }
    /// The answer in joint numbering, sorted.
    const std::vector<Pair>& colliding() const { return colliding_; }

   private:
    std::shared_ptr<void> soups_;
    std::shared_ptr<SceneBuffers> buffers_ = std::make_shared<SceneBuffers>();
    std::vector<Pair> meeting_, colliding_;
};

inline const std::vector<StageCase>& stage_cases() {
    static const std::vector<StageCase> cases = [] {
        // Far from 0, where float32 has few digits left; and a triangle far larger than its leaf.
        Soup<float> far = wavy_sheet(7);
        for (auto& p : far.vertices) p = {p[0] + 3000, p[1] - 500, p[2] + 20};
        Soup<float> ground = random_soup(120, 0.05, 12);
        const auto v = static_cast<std::int32_t>(ground.vertices.size());
        for (const std::array<float, 3>& p : {std::array{-90.f, -90.f, 0.5f}, {90.f, -90.f, 0.5f}, {0.f, 200.f, 0.6f}})
            ground.vertices.push_back(p);
        ground.triangles.push_back({v, v + 1, v + 2});
        std::vector<StageCase> all;
        all.emplace_back("soup", random_soup(150, 0.35));
        all.emplace_back("sheet in float64", wavy_sheet<double>(8));
        all.emplace_back("sheet far from 0", far);
        all.emplace_back("ground", ground);
        all.emplace_back("two soups", random_soup(80, 0.35, 3), random_soup(70, 0.35, 4));
        return all;
    }();
    return cases;
}

/// Each backend; run() tries each scene with one leaf, with one level of clusters and with two.
class Stages : public testing::TestWithParam<StageBackend> {
   protected:
    template <class Check>
    void run(Check check) {
        for (const StageCase& the : stage_cases())
            for (const auto& [clusters, leaf_size] : {std::pair{1, 3000}, {7, 3000}, {3, 10}, {20, 4}}) {
                SCOPED_TRACE(the.name + ", " + std::to_string(clusters) + " clusters, leaves of " +
                             std::to_string(leaf_size));
                check(the, GetParam().run(the.scene, {.clusters = clusters, .leaf_size = leaf_size}));
                if (HasFatalFailure()) return;
            }
    }
};

/// The exact extent of a triangle along the axes of a leaf's frame, whose numbers are taken for exact.
class ExactBox {
   public:
    ExactBox(const StageState& state, const Scene& scene, std::int32_t triangle, const LeafFrame& frame) {
        const auto exact = [](const Vec3f& p) { return value(Vec3d{p.x, p.y, p.z}); };
        for (int k = 0; k < 3; ++k) {
            const Vec3<Rational> p =
                value(state.point[static_cast<std::size_t>(scene.corners[3 * triangle + k])]) - exact(frame.origin);
            for (int axis = 0; axis < 3; ++axis) {
                const Vec3<Rational> e = exact(frame.axis[axis]);
                const Rational x = e.x * p.x + e.y * p.y + e.z * p.z;
                if (k == 0 || x < low_[axis]) low_[axis] = x;
                if (k == 0 || x > high_[axis]) high_[axis] = x;
            }
        }
    }
    bool within(const Box& box, int axis) const { return above(box.low[axis], axis) && below(box.high[axis], axis); }
    bool overlaps(const ExactBox& other, int axis) const {
        return low_[axis] <= other.high_[axis] && other.low_[axis] <= high_[axis];
    }

   private:
    bool above(double bound, int axis) const { return std::isinf(bound) || Rational(bound) <= low_[axis]; }
    bool below(double bound, int axis) const { return std::isinf(bound) || high_[axis] <= Rational(bound); }
    Vec3<Rational> low_, high_;
};

inline std::vector<ExactBox> exact_boxes(const StageState& state, const Scene& scene, const LeafState& leaf) {
    std::vector<ExactBox> boxes;
    for (const std::int32_t t : leaf.member) boxes.emplace_back(state, scene, t, leaf.frame);
    return boxes;
}

}  // namespace crumple::test
