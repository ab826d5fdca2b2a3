// Tests that normalised coordinates are at most 1 and, for float32 input, exact as float32 unless they are
// subnormal.

#include "geometry/normaliser.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace crumple {
namespace {

TEST(Normaliser, normalising_float32_is_lossless_unless_results_are_subnormal) {
    std::mt19937 engine(7);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };  // -1 to 1
    for (int round = 0; round < 2000; ++round) {
        // Random boxes: around 0, far from it, thin, from subnormal to huge.
        const double offset = std::ldexp(number(), static_cast<int>(engine() % 240) - 120);
        const double size = std::ldexp(1.0, static_cast<int>(engine() % 240) - 120);
        std::vector<Vec3d> points;
        constexpr double most = std::numeric_limits<double>::max();
        Vec3d low{most, most, most}, high{-most, -most, -most};
        for (int i = 0; i < 20; ++i) {
            Vec3d p;
            for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(offset + size * number());
            points.push_back(p);
            low = min(low, p);
            high = max(high, p);
        }
        const Normaliser normalise(low, high);
        for (const Vec3d& p : points) {
            const Vec3d y = normalise(p);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_LE(std::abs(y[axis]), 1.0);
                if (std::abs(y[axis]) < 0x1p-126) continue;  // below float32's normal range at this scale
                EXPECT_EQ(static_cast<double>(static_cast<float>(y[axis])), y[axis]) << p[axis];
                EXPECT_EQ(normalise.inverse(y)[axis], p[axis]);
            }
        }
    }
}

TEST(Normaliser, extremes_of_float64_stay_finite_and_keep_their_order) {
    constexpr double most = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
    {
        const Normaliser normalise({-most, -most, 0}, {most, most, most});
        EXPECT_EQ(normalise({most, -most, 0}).x, -normalise({-most, -most, 0}).x);
        EXPECT_LE(normalise({most, 0, 0}).x, 1);
        EXPECT_GT(normalise({most, 0, 0}).x, 0.25);
    }
    {
        const Normaliser normalise({0, 0, 0}, {5 * least, least, least});
        const Vec3d y = normalise({5 * least, least, 0});
        EXPECT_LE(y.x, 1);
        EXPECT_GT(y.x, 0);
        EXPECT_EQ(y.x, 5 * y.y);
    }
    const Normaliser point({0, 0, 0}, {0, 0, 0});
    EXPECT_EQ(point({0, 0, 0}), (Vec3d{0, 0, 0}));
}

}  // namespace
}  // namespace crumple
