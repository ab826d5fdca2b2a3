// Checks that bounds on the distance of boxes and of posed triangles never exceed the distance of their points.

#include <gtest/gtest.h>

#include <cmath>

#include "scene/box_distance.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

/// Returns a random pose: often any matrix, whose axes are neither orthogonal nor of equal length, sometimes a motion.
Pose any_pose(Dice& dice) {
    Pose pose = random_pose(dice, 3);
    if (dice.chance(0.3)) return pose;
    for (double& x : pose.rows) x = dice.between(-2, 2);
    if (dice.chance(0.3))
        for (std::size_t i = 0; i < 12; i += 4) pose.rows[i + 1] = 1.01 * pose.rows[i];  // nearly parallel columns
    return pose;
}

struct PosedShape {
    PosedShape(const Pose& pose, double size, Dice& dice)
        : pose(pose),
          place(&this->pose, false),
          size(size),
          frame(CentredBox(Bounds{{-size, -size, -size}, {size, size, size}})) {
        Bounds part = no_bounds;
        for (int i = 0; i < 2; ++i) part.widen(Vec3d{coordinate(dice), coordinate(dice), coordinate(dice)});
        box = part;
    }
    double coordinate(Dice& dice) const { return dice.between(-size, size); }
    /// Returns a posed point of the box, sometimes a corner.
    Vec3d point(Dice& dice) const { return place(unposed_point(dice)); }
    Vec3d unposed_point(Dice& dice) const {
        const auto within = [&](double low, double high) {
            return dice.chance(0.4) ? low : dice.chance(0.6) ? high : dice.between(low, high);
        };
        return {within(box.low.x, box.high.x), within(box.low.y, box.high.y), within(box.low.z, box.high.z)};
    }

    Pose pose;
    Placement place;
    double size;
    SmallFrame frame;
    Bounds box;
};

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

TEST(BoxDistance, lower_bound_is_at_most_the_distance_of_sampled_points) {
    int apart = 0;
    for (unsigned seed = 0; seed < 2000; ++seed) {
        SCOPED_TRACE(seed);
        Dice dice(seed);
        const PosedShape a(any_pose(dice), dice.between(0.1, 3), dice), b(any_pose(dice), dice.between(0.1, 3), dice);
        const Vec3d direction = dice.chance(0.2) ? Vec3d{} : Vec3d{dice.between(-1, 1), dice.between(-1, 1), 0.5};
        const BoxDistance boxes(a.place, a.frame, b.place, b.frame, direction);
        const float between = gap(boxes.a()(a.frame(CentredBox(a.box))), boxes.b()(b.frame(CentredBox(b.box))));
        apart += between > 0;
        for (int i = 0; i < 60; ++i) {
            const Vec3d p = a.point(dice), q = b.point(dice);
            ASSERT_FALSE(between > boxes.limit(length(p - q)));
            const Vec3d r = a.point(dice), s = b.point(dice);
            const float triangles =
                gap(boxes.a()(boxes(p), boxes(p), boxes(r)), boxes.b()(boxes(q), boxes(s), boxes(q)));
            for (const Vec3d& x : {p, r, 0.5 * (p + r)})
                for (const Vec3d& y : {q, s, 0.5 * (q + s)}) ASSERT_FALSE(triangles > boxes.limit(length(x - y)));
        }
    }
    EXPECT_GT(apart, 200);
}

TEST(BoxDistance, lower_bound_of_a_step_is_at_most_the_distance_of_sampled_points) {
    int apart = 0;
    for (unsigned seed = 0; seed < 2000; ++seed) {
        SCOPED_TRACE(seed);
        Dice dice(seed);
        PosedShape a(any_pose(dice), dice.between(0.1, 3), dice), b(any_pose(dice), dice.between(0.1, 3), dice);
        const auto end_of = [&](const Pose& start) {
            if (dice.chance(0.3)) return any_pose(dice);
            Pose end = start;
            for (std::size_t i = 3; i < 12; i += 4) end.rows[i] += dice.between(-1, 1);
            return end;
        };
        const Pose end_a = end_of(a.pose), end_b = end_of(b.pose);
        const BoxDistance::Step step_a{a.place, Placement(&end_a, false)}, step_b{b.place, Placement(&end_b, false)};
        const BoxDistance boxes(step_a, a.frame, step_b, b.frame);
        const float between =
            gap(boxes.a().swept(a.frame(CentredBox(a.box))), boxes.b().swept(b.frame(CentredBox(b.box))));
        apart += between > 0;
        for (int i = 0; i < 60; ++i) {
            const double t = dice.chance(0.3) ? 0 : dice.chance(0.3) ? 1 : dice.number();
            const auto at = [&](const PosedShape& shape, const BoxDistance::Step& step) {
                const Vec3d p = shape.unposed_point(dice);
                return (1 - t) * step.start(p) + t * step.end(p);
            };
            const Vec3d p = at(a, step_a), q = at(b, step_b);
            ASSERT_FALSE(between > boxes.limit(length(p - q) * (1 + 1e-14)));
        }
    }
    EXPECT_GT(apart, 200);
}

/// Cubes face to face, edge to edge and corner to corner. Poses are translations.
TEST(BoxDistance, lower_bound_nearly_equals_the_distance_of_axis_aligned_cubes) {
    const Bounds cube{{-1, -1, -1}, {1, 1, 1}};
    const SmallFrame frame{CentredBox(cube)};
    const SmallBox box = frame(CentredBox(cube));
    for (const Vec3d& step : {Vec3d{5, 0, 0}, Vec3d{5, 6, 0}, Vec3d{5, 6, 7}}) {
        const Pose pose{{1, 0, 0, step.x, 0, 1, 0, step.y, 0, 0, 1, step.z}};
        const Placement a(nullptr, false), b(&pose, false);
        const BoxDistance boxes(a, frame, b, frame, {});
        const float between = gap(boxes.a()(box), boxes.b()(box));
        const Vec3d least = max(step - Vec3d{2, 2, 2}, Vec3d{});
        EXPECT_FALSE(between > boxes.limit(length(least)));
        EXPECT_GT(between, boxes.limit(0.999 * length(least)));
    }
}

}  // namespace
}  // namespace crumple::test
