#pragma once

// Bounds on the volumes of bodies. Host only.

#include <algorithm>
#include <cmath>

#include "search/overlap/overlap_windings.h"

namespace crumple {

/// Lower and upper bound on six times the volume of a body.
struct VolumeBounds {
    double low = 0, high = 0;
};
inline VolumeBounds bounds_of_volume(const PlacedSurface& body, const Vec3d& origin) {
    double sum = 0, magnitude = 0;
    const std::int32_t faces = body.surface->face_count();
    for (std::int32_t f = 0; f < faces; ++f) {
        const FaceCorners p = body.corners(f);
        const Vec3d x = p[0] - origin, y = p[1] - origin, z = p[2] - origin;
        sum += dot(x, cross(y, z));
        const Vec3d size_x = abs(x), size_y = abs(y), size_z = abs(z);
        magnitude += size_x.x * (size_y.y * size_z.z + size_y.z * size_z.y) +
                     size_x.y * (size_y.z * size_z.x + size_y.x * size_z.z) +
                     size_x.z * (size_y.x * size_z.y + size_y.y * size_z.x);
    }
    // Each term is rounded at most eight times, and the sum once per face.
    const double error = 0x1p-52 * (faces + 16) * magnitude;
    return {sum - error, sum + error};
}

}  // namespace crumple
