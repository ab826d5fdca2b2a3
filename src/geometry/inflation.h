#pragma once

// Inflation of a primitive's ball and box, in normalised coordinates, for queries whose results include pairs that do
// not touch: if two primitives may be part of the result, their balls overlap, and so do their inflated boxes. Compiled
// for host and device.

#include <cstdint>

#include "geometry/normaliser.h"

namespace crumple {

/// Upper bound on the distance of two points in normalised coordinates.
inline constexpr float farthest = 4;

/// Converts a length from the scene's units to normalised coordinates, rounded once and limited to `farthest`.
CRUMPLE_HD inline float normalised_length(double length, const Normaliser& normaliser) {
    return static_cast<float>(min(double{farthest}, length * normaliser.pre * normaliser.post));
}

/// Bound on what the length of a trajectory loses if its squares underflow in float32: three squares of up to 2^-126
/// each.
inline constexpr float lost_length = 2e-19f;

/// Parameters of an inflation. A primitive is inflated by `half`, half the requested distance. If the request is for a
/// share s of a pair's distance at the start, the primitive is also inflated by `path_share`, s / (1 - s), times the
/// longest path of its corners: features that approach from distance d to s d have together moved by at least (1 - s) d
/// (docs/features.md). If vertices have radii, the largest radius of the primitive's vertices replaces `half`.
struct Inflation {
    float half = 0, path_share = 0;
    bool of_box = false;            ///< true if a ball has to contain the primitive's inflated axis-aligned box
    const float* radius = nullptr;  ///< 1 per primitive, used instead of `half`, which is the largest of them; or null

    CRUMPLE_HD bool none() const { return half == 0 && path_share == 0 && !of_box; }
    /// Returns the parameters for one primitive, with its own radius as `half` if there are radii.
    CRUMPLE_HD Inflation of(std::int64_t primitive) const {
        return {radius ? radius[primitive] : half, path_share, of_box, nullptr};
    }
    /// Returns the inflation of a primitive whose corners move by at most `way`, rounded up and limited to `farthest`,
    /// which suffices because coordinates are at most 1.
    CRUMPLE_HD float operator()(float way) const {
        return min(farthest, (half + path_share * (way + lost_length)) * 1.000002f);
    }
};

}  // namespace crumple
