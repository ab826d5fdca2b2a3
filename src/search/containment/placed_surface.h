#pragma once

// Surface of a body where its pose puts it.

#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/triangle.h"
#include "scene/closed_surface.h"
#include "scene/placement.h"

namespace crumple {

/// True if all coordinates are 0 or in the range of double words.
inline bool in_double_word_range(const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis)
        if (p[axis] != 0 && !(std::abs(p[axis]) >= 0x1p-150 && std::abs(p[axis]) <= 0x1p150)) return false;
    return true;
}

/// A body where it is.
struct PlacedSurface {
    const ClosedSurface* surface = nullptr;
    const Vec3d* points = nullptr;  ///< by vertex
    Bounds box = no_bounds;
    bool in_range = true;  ///< of double words

    std::array<Vec3d, 3> corners(std::int32_t face) const {
        const std::int32_t* c = surface->corners(face);
        return {points[c[0]], points[c[1]], points[c[2]]};
    }
};

}  // namespace crumple
