#pragma once

// Winding numbers of a surface at points, by a ray from each along +x.

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/cancellation.h"
#include "exact/overlap/face_crossing.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// A ray along +x.
struct WindingRay {
    Vec3d from;
    std::size_t of;        ///< what the ray is for, as the caller counts
    std::int32_t winding;  ///< sum over the faces that were cast so far; initially 0
};

/// Adds the winding numbers of a surface, which is shifted, where rays start, and sorts the rays. Cost: a logarithm of
/// the number of rays for each face, and what rays meet.
void cast(std::span<WindingRay> rays, const PlacedSurface& surface, Shift shift, Cancellation& cancellation);

}  // namespace crumple
