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
inline VolumeBounds bounds_of_volume(const PlacedSurface& body) {
    const std::int32_t faces = body.surface->face_count();
    const Vec3d origin = 0.5 * body.box.low + 0.5 * body.box.high, extent = body.box.high - body.box.low;
    double sum = 0;
    for (std::int32_t f = 0; f < faces; ++f) {
        const std::int32_t* c = body.surface->corners(f);
        sum += dot(body.points[c[0]] - origin, cross(body.points[c[1]] - origin, body.points[c[2]] - origin));
    }
    // Each of the six products of a term is at most the volume of the box, and rounded at most eight times; the sum is
    // rounded once per face.
    const double error = 0x1p-52 * (faces + 16) * (6.0 * faces) * (extent.x * extent.y * extent.z);
    return {sum - error, sum + error};
}

}  // namespace crumple
