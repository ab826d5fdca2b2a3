#pragma once

// Winding numbers of a surface at points, by one ray along +x from each point.

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/cancellation.h"
#include "exact/overlap/face_crossing.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// Ray along +x.
struct WindingRay {
    Vec3d from;
    std::size_t of;        ///< an index that the caller chooses, to recognise the ray
    std::int32_t winding;  ///< sum over the faces tested so far; initially 0
};

/// Adds the crossing of one face with the ray to the winding number. `surface` is shifted infinitesimally
/// (exact/overlap/face_crossing.h). Cost: some nanoseconds if the face's box misses the ray.
void add_crossing(const PlacedSurface& surface, std::int32_t face, Shift shift, WindingRay& ray);

/// Adds to each ray the winding number at its start of a surface that is shifted infinitesimally
/// (exact/overlap/face_crossing.h). Reorders the rays. Cost: O((m + n) log n + k) for m faces, n rays, and k pairs of a
/// face and a ray that overlap in y.
void cast_rays(std::span<WindingRay> rays, const PlacedSurface& surface, Shift shift, Cancellation& cancellation);

}  // namespace crumple
