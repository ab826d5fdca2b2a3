#pragma once

// Random features of small integers, from a seed: the smaller the numbers, the more of them are degenerate.

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "proximities/feature_builders.h"

namespace crumple {

enum class Points {
    tiny,   ///< coordinates -1, 0, 1: every kind of degeneracy
    small,  ///< -3 to 3
    wide,   ///< -50 to 50: mostly in general position
    plane,  ///< -3 to 3, in the plane x + y + z = 0
    line,   ///< -4 to 4 times (1, -1, 2)
};
inline constexpr std::array all_points{Points::tiny, Points::small, Points::wide, Points::plane, Points::line};

class RandomFeatures {
   public:
    RandomFeatures(Points points, std::uint64_t seed) : points_(points), engine_(seed) {}

    Features operator()(FeatureKinds kinds) {
        return with_points({kinds, {}}, [&](const Vec3d&) { return position(); });
    }

    /// Returns a number from 0 to n - 1, the same on every machine.
    int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }

   private:
    Vec3d position() {
        if (points_ == Points::line) return static_cast<double>(below(9) - 4) * Vec3d{1, -1, 2};
        const int extent = points_ == Points::tiny ? 1 : points_ == Points::wide ? 50 : 3;
        const auto number = [&] { return static_cast<double>(below(2 * extent + 1) - extent); };
        Vec3d p{number(), number(), number()};
        if (points_ == Points::plane) p.z = -p.x - p.y;
        return p;
    }

    Points points_;
    std::mt19937_64 engine_;
};

/// Calls `check` with some features of each kind, with coordinates of each kind of Points, until it fails.
template <class Check>
void for_features(std::uint64_t seed, int rounds, Check check) {
    for (const FeatureKinds kinds : all_kinds) {
        for (const Points points : all_points) {
            RandomFeatures random(points, seed);
            for (int i = 0; i < rounds; ++i) {
                check(random(kinds), random);
                if (testing::Test::HasFatalFailure()) return;
            }
        }
    }
}

}  // namespace crumple
