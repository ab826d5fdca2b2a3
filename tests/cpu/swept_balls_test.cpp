// Tests of the balls of moving triangles, for the kernels of every instruction set: a ball holds the corners at t0 and
// t1, and everything within the given distance of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "backends/cpu/stages/kernels.h"

namespace crumple::cpu {
namespace {

class SweptBalls : public testing::TestWithParam<bool> {
   protected:
    static constexpr std::int64_t vertices = 50, triangles = 43;

    /// Makes random positions at t0 and t1, float32 numbers if the test's parameter is true, and random triangles.
    SweptBalls() {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> coordinate(-1, 1);
        std::uniform_int_distribution<std::int32_t> vertex(0, vertices - 1);
        for (std::int64_t row = 0; row < 2 * vertices; ++row)
            for (int axis = 0; axis < 4; ++axis) {
                const double x = axis == 3 ? 0 : coordinate(random);
                single_.push_back(static_cast<float>(x));
                double_.push_back(GetParam() ? double{single_.back()} : x);
            }
        single_.resize(single_.size() + padding);
        double_.resize(double_.size() + padding);
        for (std::int64_t i = 0; i < 3 * triangles; ++i) corners_.push_back(vertex(random));
    }

    Vec3d at(std::int64_t row) const {
        const double* p = double_.data() + 4 * row;
        return {p[0], p[1], p[2]};
    }

    void expect_balls(std::int64_t ends, float more) {
        const PointRows rows = GetParam() ? PointRows{single_.data(), nullptr} : PointRows{nullptr, double_.data()};
        for (const StageKernels* kernels : all_stage_kernels()) {
            std::vector<Ball> balls(triangles + padding);
            kernels->balls(rows, corners_.data(), 0, triangles, ends, more, balls.data());
            for (std::int64_t t = 0; t < triangles; ++t) {
                const Ball& ball = balls[static_cast<std::size_t>(t)];
                double farthest = 0;
                for (int k = 0; k < 3; ++k)
                    for (const std::int64_t end : {std::int64_t{0}, ends}) {
                        const Vec3d from = at(corners_[static_cast<std::size_t>(3 * t + k)] + end) -
                                           Vec3d{double{ball.x}, double{ball.y}, double{ball.z}};
                        farthest = std::max(farthest, std::sqrt(dot(from, from)));
                    }
                EXPECT_GE(double{ball.r}, farthest + double{more}) << kernels->name;
                EXPECT_LE(double{ball.r}, farthest + double{more} + 8e-6) << kernels->name;
            }
        }
    }

   private:
    std::vector<float> single_;
    std::vector<double> double_;
    std::vector<std::int32_t> corners_;
};
INSTANTIATE_TEST_SUITE_P(Float32, SweptBalls, testing::Bool());

TEST_P(SweptBalls, balls_hold_the_whole_trajectory) { expect_balls(vertices, 0); }
TEST_P(SweptBalls, balls_hold_the_vicinity_of_the_trajectory) { expect_balls(vertices, 0.25f); }
TEST_P(SweptBalls, balls_hold_the_vicinity_of_a_static_triangle) { expect_balls(0, 0.25f); }

}  // namespace
}  // namespace crumple::cpu
