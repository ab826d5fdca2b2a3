#pragma once

// Sine, cosine and angle that give the same bits on every machine, which the C library's functions do not promise.
//
// Angles are in turns, so that reduction to one period is exact. Errors are about 1e-14: a scene needs the same result
// on every machine, not the last bit.

#include <cmath>

#include "geometry/vec.h"

namespace crumple::scenes {

inline constexpr double pi = 3.141592653589793;

inline double cosine(double turns) {
    double x = std::abs(turns - std::floor(turns + 0.5));  // in [0, 1/2]
    const bool negative = x > 0.25;
    if (negative) x = 0.5 - x;
    const double y = -(2 * pi * x) * (2 * pi * x);
    double sum = 1;
    for (int k = 20; k > 0; k -= 2) sum = 1 + sum * y / (k * (k - 1));  // Taylor series, by Horner's method
    return negative ? -sum : sum;
}

inline double sine(double turns) { return cosine(turns - 0.25); }

/// Returns the angle of (x, y) in turns, in (-1/2, 1/2]; 0 at the origin.
inline double angle(double y, double x) {
    if (x == 0 && y == 0) return 0;
    const double length = std::sqrt(x * x + y * y);
    double t = y / (length + std::abs(x));  // tangent of half the angle to the nearer half of the x axis, at most 1
    for (int i = 0; i < 2; ++i) t = t / (1 + std::sqrt(1 + t * t));
    double sum = 0;
    for (int k = 19; k > 0; k -= 2) sum = 1.0 / k - t * t * sum;
    const double turns = 8 * t * sum / (2 * pi);
    return x >= 0 ? turns : (y < 0 ? -0.5 : 0.5) - turns;
}

inline double length(Vec3d a) { return std::sqrt(dot(a, a)); }
/// Returns the vector scaled to length 1; zero stays zero.
inline Vec3d normalised(Vec3d a) {
    const double l = length(a);
    return l > 0 ? (1 / l) * a : a;
}

/// Returns a number that rises from 0 to 1 as x goes from `low` to `high`, with slope 0 at both ends.
inline double smooth_step(double low, double high, double x) {
    const double t = std::fmin(1, std::fmax(0, (x - low) / (high - low)));
    return t * t * (3 - 2 * t);
}

}  // namespace crumple::scenes
