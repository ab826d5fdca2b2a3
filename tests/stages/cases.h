#pragma once

// Scenes for the tests of the stages, exact results for them, and the fixture.

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <tuple>

#include "exact/impact/exact_min_distance.h"
#include "exact/intersection/exact_intersection.h"
#include "filters/features/feature_points.h"
#include "geometry/exact.h"
#include "soups.h"
#include "stages/state.h"

namespace crumple::test {

/// A scene and its pairs of triangles with a common point; for a moving scene, the pairs with features that come within
/// query_distance.
class StageCase {
   public:
    std::string name;
    PreparedScene scene;

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
                if (collide(exact, Neighbours::geometric, IntersectionKind::all)) colliding_.push_back({i, j});
            }
    }

    /// Returns a case of a moving mesh.
    template <class Scalar>
    static StageCase moving(std::string what, Soup<Scalar> start, Soup<Scalar> end) {
        StageCase the(std::move(what), std::move(start));
        the.end_ = std::make_shared<Soup<Scalar>>(std::move(end));
        ParallelFor serial;
        add_motion(std::static_pointer_cast<Soup<Scalar>>(the.end_)->view().vertices, serial, *the.buffers_, the.scene);
        the.meeting_.clear();
        the.colliding_.clear();
        for (std::int32_t i = 0; i < the.scene.triangle_count(); ++i)
            for (std::int32_t j = i + 1; j < the.scene.triangle_count(); ++j)
                if (the.come_close(i, j)) the.meeting_.push_back({i, j});
        return the;
    }

    /// Returns the pairs that a search must find, sorted.
    const std::vector<Pair>& meeting() const { return meeting_; }
    /// Returns the colliding pairs in joint numbering, sorted.
    const std::vector<Pair>& colliding() const { return colliding_; }

   private:
    bool come_close(std::int32_t i, std::int32_t j) const {
        const std::int32_t *a = scene.corners + 3 * i, *b = scene.corners + 3 * j;
        const MinDistance within{query_distance, 0};
        const auto at = [&](std::int32_t v) { return moving_point(scene, v); };
        for (int axis = 0; axis < 3; ++axis) {
            const auto extent = [&](const std::int32_t* c) {
                const auto [p, q, r] = std::array{at(c[0]), at(c[1]), at(c[2])};
                return std::minmax(
                    {p.start[axis], p.end[axis], q.start[axis], q.end[axis], r.start[axis], r.end[axis]});
            };
            const auto [low_a, high_a] = extent(a);
            const auto [low_b, high_b] = extent(b);
            if (low_a > high_b + 2 * query_distance || low_b > high_a + 2 * query_distance) return false;
        }
        for (int k = 0; k < 3; ++k) {
            if (vertex_face(at(a[k]), at(b[0]), at(b[1]), at(b[2]), within).meets ||
                vertex_face(at(b[k]), at(a[0]), at(a[1]), at(a[2]), within).meets)
                return true;
            for (int l = 0; l < 3; ++l)
                if (edge_edge(at(a[k]), at(a[(k + 1) % 3]), at(b[l]), at(b[(l + 1) % 3]), within).meets) return true;
        }
        return false;
    }

    std::shared_ptr<void> soups_, end_;
    std::shared_ptr<SceneBuffers> buffers_ = std::make_shared<SceneBuffers>();
    std::vector<Pair> meeting_, colliding_;
};

inline const std::vector<StageCase>& stage_cases() {
    static const std::vector<StageCase> cases = [] {
        // A scene far from 0, where float32 has a low resolution, and a scene with one triangle far larger than the
        // others.
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
        // Each vertex has its own trajectory, most of them short, some long; in the last scene a sheet folds.
        Soup<float> start = random_soup(70, 0.2, 5), end = start;
        for (std::size_t v = 0; v < end.vertices.size(); ++v)
            for (std::size_t axis = 0; axis < 3; ++axis)
                end.vertices[v][axis] +=
                    (v % 15 == 0 ? 0.5f : 0.1f) * (start.vertices[v / 3 * 3][(axis + 1) % 3] - 0.5f);
        all.push_back(StageCase::moving("soup that moves", start, end));
        all.push_back(
            StageCase::moving("sheet that folds, in float64", wavy_sheet<double>(5), wavy_sheet<double>(5, 0.7)));
        return all;
    }();
    return cases;
}

/// Fixture for each backend. run() calls `check` for each scene with one leaf, with one level of clusters and with two
/// levels; also for moving scenes if the backend supports them.
class Stages : public testing::TestWithParam<StageBackend> {
   protected:
    template <class Check>
    void run(Check check) {
        run(check, GetParam().moves);
    }
    template <class Check>
    void run_static(Check check) {
        run(check, false);
    }

   private:
    template <class Check>
    void run(Check check, bool moving) {
        for (const StageCase& the : stage_cases()) {
            if (the.scene.moving && !moving) continue;
            for (const auto& [clusters, leaf_size] : {std::pair{1, 3000}, {7, 3000}, {3, 10}, {20, 4}}) {
                SCOPED_TRACE(the.name + ", " + std::to_string(clusters) + " clusters, leaves of " +
                             std::to_string(leaf_size));
                check(the, state_of(the, {.clusters = clusters, .leaf_size = leaf_size}));
                if (HasFatalFailure()) return;
            }
        }
    }

    /// Returns the state of the stages, which the backend computes once in a process for all tests.
    static const StageState& state_of(const StageCase& the, const Options& options) {
        static std::map<std::tuple<std::string, std::string, int, int>, StageState> states;
        const StageBackend& backend = GetParam();
        const auto [state, fresh] = states.try_emplace({backend.name, the.name, options.clusters, options.leaf_size});
        if (fresh) state->second = backend.run(the.scene, options);
        return state->second;
    }
};

/// Exact extent of a triangle, throughout its motion, along the axes of a leaf's frame. The float32 numbers of the
/// frame are taken as exact.
class ExactBox {
   public:
    ExactBox(const StageState& state, const PreparedScene& scene, std::int32_t triangle, const LeafFrame& frame) {
        const auto exact = [](const Vec3f& p) { return value(Vec3d{p.x, p.y, p.z}); };
        for (int k = 0; k < (scene.moving ? 6 : 3); ++k) {
            const std::int64_t at = scene.corners[3 * triangle + k % 3] + (k < 3 ? 0 : scene.vertex_count());
            const Vec3<Rational> p = value(state.point[static_cast<std::size_t>(at)]) - exact(frame.origin);
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

inline std::vector<ExactBox> exact_boxes(const StageState& state, const PreparedScene& scene, const LeafState& leaf) {
    std::vector<ExactBox> boxes;
    for (const std::int32_t t : leaf.member) boxes.emplace_back(state, scene, t, leaf.frame);
    return boxes;
}

}  // namespace crumple::test
