#pragma once

// Products of poses, for the nested transforms of scenes.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "crumple/world.h"

namespace crumple::io {

/// Returns the pose that applies `inner`, then `outer`.
inline Pose product(const Pose& outer, const Pose& inner) {
    const auto& a = outer.rows;
    const auto& b = inner.rows;
    Pose result;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            const double sum = (a[4 * i] * b[k] + a[4 * i + 1] * b[4 + k]) + a[4 * i + 2] * b[8 + k];
            result.rows[4 * i + k] = k == 3 ? sum + a[4 * i + 3] : sum;
        }
    }
    return result;
}

inline bool is_finite(const Pose& pose) {
    return std::all_of(pose.rows.begin(), pose.rows.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace crumple::io
