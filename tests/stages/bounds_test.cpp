// Tests of stage `bounds`: vertices are mapped exactly, and the ball holds the triangle throughout its motion.

#include "geometry/normaliser.h"
#include "stages/cases.h"

namespace crumple::test {
namespace {

using Bounds = Stages;
INSTANTIATE_TEST_SUITE_P(, Bounds, testing::ValuesIn(stage_backends()), [](const auto& b) { return b.param.name; });

TEST_P(Bounds, vertices_are_mapped_into_minus_1_to_1_without_rounding) {
    run([](const StageCase& the, const StageState& state) {
        const Normaliser map(the.scene.low, the.scene.high);
        const std::int64_t n = the.scene.vertex_count(), rows = the.scene.moving ? 2 * n : n;
        ASSERT_EQ(state.point.size(), static_cast<std::size_t>(rows));
        for (std::int64_t v = 0; v < rows; ++v) {
            const Vec3<Rational> given = value(v < n ? the.scene.position(v) : the.scene.end(v - n));
            const Vec3<Rational> shift = value(map.shift);
            const Vec3d found = state.point[static_cast<std::size_t>(v)];
            for (int axis = 0; axis < 3; ++axis) {
                const Rational exact = (given[axis] * Rational(map.pre) - shift[axis]) * Rational(map.post);
                ASSERT_EQ(Rational(found[axis]), exact) << "vertex " << v << ", axis " << axis;
                ASSERT_LE(std::abs(found[axis]), 1);
            }
        }
    });
}

TEST_P(Bounds, ball_holds_the_triangle_at_the_start_and_end) {
    run([](const StageCase& the, const StageState& state) {
        ASSERT_EQ(state.ball.size(), static_cast<std::size_t>(the.scene.triangle_count()));
        for (std::size_t t = 0; t < state.ball.size(); ++t) {
            const Ball& ball = state.ball[t];
            const Vec3<Rational> centre = value(Vec3d{ball.x, ball.y, ball.z});
            const Rational r(ball.r);
            for (std::size_t k = 0; k < (the.scene.moving ? 6 : 3); ++k) {
                const std::int64_t row = the.scene.corners[3 * t + k % 3] + (k < 3 ? 0 : the.scene.vertex_count());
                const Vec3<Rational> d = value(state.point[static_cast<std::size_t>(row)]) - centre;
                ASSERT_LE(d.x * d.x + d.y * d.y + d.z * d.z, r * r) << "triangle " << t << ", corner " << k;
            }
        }
    });
}

}  // namespace
}  // namespace crumple::test
