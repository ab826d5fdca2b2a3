#pragma once

// Requested distances in the normalised coordinates of a scene, rounded up: balls and boxes are inflated by them, and
// filters compare with them. Compiled for host and device.

#include "geometry/inflation.h"

namespace crumple {

/// Returns the inflation for a distance, and for a share in [0, 1) of a pair's own distance at the start.
CRUMPLE_HD inline Inflation inflation_of(const Normaliser& normaliser, double distance, double share) {
    Inflation inflation;
    if (distance > 0) inflation.half = normalised_length(distance, normaliser) * 0.500001f + 1e-30f;
    if (share > 0) inflation.path_share = static_cast<float>(min(1e30, share / (1 - share))) * 1.000001f;
    return inflation;
}

/// Returns a vertex's radius in normalised coordinates.
CRUMPLE_HD inline float radius_of(const Normaliser& normaliser, double radius) {
    return normalised_length(radius, normaliser) * 1.000002f + 1e-30f;
}

}  // namespace crumple
