#pragma once

// Random numbers that are the same on every machine: SplitMix64 (Steele, Lea, Flood 2014) and values derived from it.

#include <cmath>
#include <cstdint>

#include "geometry/vec.h"
#include "scenes/arithmetic.h"

namespace crumple::scenes {

/// Mixes 64 bits by a bijection in which every input bit affects every output bit.
inline std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

class Random {
   public:
    explicit Random(std::uint64_t seed) : state_(mix(seed + 1)) {}

    std::uint64_t bits() { return mix(state_ += step); }
    /// Advances the state as `calls` calls of bits() do.
    void skip(std::uint64_t calls) { state_ += calls * step; }
    /// Returns a number in [0, 1).
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Returns an integer from 0 to count - 1.
    int integer(int count) { return static_cast<int>((bits() >> 32) * static_cast<std::uint64_t>(count) >> 32); }
    Vec3d in_cube(double low, double high) {
        const double x = uniform(low, high), y = uniform(low, high);
        return {x, y, uniform(low, high)};
    }
    /// Returns a unit vector; all directions are equally likely.
    Vec3d direction() {
        for (;;) {
            const Vec3d v = in_cube(-1, 1);
            const double square = dot(v, v);
            if (square > 1e-4 && square <= 1) return normalised(v);
        }
    }

   private:
    static constexpr std::uint64_t step = 0x9e3779b97f4a7c15u;
    std::uint64_t state_;
};

/// Returns smooth noise in the plane, in [-1, 1]: random values at integer points, blended between them.
inline double noise(std::uint64_t seed, double x, double y) {
    const double column = std::floor(x), row = std::floor(y);
    const auto at = [&](double i, double j) {
        const auto cell = static_cast<std::uint64_t>(static_cast<std::int64_t>(i)) << 32 ^
                          (static_cast<std::uint64_t>(static_cast<std::int64_t>(j)) & 0xffffffffu);
        return static_cast<double>(mix(mix(seed + 1) ^ cell) >> 11) * 0x1p-52 - 1;
    };
    const double s = smooth_step(0, 1, x - column), t = smooth_step(0, 1, y - row);
    const double low = at(column, row) + s * (at(column + 1, row) - at(column, row));
    const double high = at(column, row + 1) + s * (at(column + 1, row + 1) - at(column, row + 1));
    return low + t * (high - low);
}

}  // namespace crumple::scenes
