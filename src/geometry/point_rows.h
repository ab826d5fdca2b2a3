#pragma once

// The normalised vertices, as stages after `bounds` read them: rows of four, the last element 0. Compiled for host and
// device.

#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// float32 rows where those are exact, else float64 ones: one pointer is null.
struct PointRows {
    const float* f = nullptr;
    const double* d = nullptr;

    /// A vertex, without loss.
    CRUMPLE_HD Vec3d operator[](std::int32_t vertex) const {
        const std::int64_t i = 4 * static_cast<std::int64_t>(vertex);
        if (f) return {f[i], f[i + 1], f[i + 2]};
        return {d[i], d[i + 1], d[i + 2]};
    }

    /// Of a vertex that is wanted soon.
    void prefetch(std::int32_t vertex) const {
        const std::int64_t i = 4 * static_cast<std::int64_t>(vertex);
        __builtin_prefetch(f ? static_cast<const void*>(f + i) : d + i);
    }
};

}  // namespace crumple
