#pragma once

// Surface of a body under its pose, for winding numbers and overlaps.

#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/triangle.h"
#include "scene/closed_surface.h"
#include "scene/placement.h"

namespace crumple {

/// True if all coordinates are 0 or have a magnitude in the range of double-double arithmetic, 2^-150 to 2^150.
inline bool in_double_word_range(const Vec3d& p) {
    const auto is_in_range = [](double x) {
        const double size = std::abs(x);
        return (size == 0) | ((size >= 0x1p-150) & (size <= 0x1p150));  // without branches
    };
    return is_in_range(p.x) & is_in_range(p.y) & is_in_range(p.z);
}

/// View of a surface under a body's pose.
struct PlacedSurface {
    const ClosedSurface* surface = nullptr;
    const Vec3d* points = nullptr;  ///< posed position of each vertex; not owned
    Bounds box = no_bounds;
    bool in_range = true;  ///< true if all points are in the range of double-double arithmetic
    std::int64_t vertex_count = 0;

    std::array<Vec3d, 3> corners(std::int32_t face) const {
        const std::int32_t* c = surface->corners(face);
        return {points[c[0]], points[c[1]], points[c[2]]};
    }
};

/// Returns the box of all faces. `surface.box` also contains the vertices that no face names.
inline Bounds box_of_faces(const PlacedSurface& surface) {
    if (surface.surface->places() == surface.vertex_count) return surface.box;
    Bounds box = no_bounds;
    for (std::int32_t face = 0; face < surface.surface->face_count(); ++face)
        for (const Vec3d& p : surface.corners(face)) box.widen(p);
    return box;
}

}  // namespace crumple
