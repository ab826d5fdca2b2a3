#pragma once

// By how much a primitive's ball and box are widened for a question that asks for less than contact, in normalised
// coordinates: two primitives that may be an answer have balls, and boxes, that overlap. Compiled for host and device.

#include <cstdint>

#include "geometry/normaliser.h"

namespace crumple {

/// What no two points of normalised coordinates exceed.
inline constexpr float farthest = 4;

/// A length of the scene in normalised coordinates, rounded once, and at most what holds everything.
CRUMPLE_HD inline float normalised_length(double length, const Normaliser& normaliser) {
    return static_cast<float>(min(double{farthest}, length * normaliser.pre * normaliser.post));
}

/// What the length of a way may lose where its squares are too small for float32: three of up to 2^-126 each.
inline constexpr float lost_way = 2e-19f;

/// Half the distance that is asked for; and, for a share s of a pair's own distance at the start, s / (1 - s) times how
/// far the primitive moves at most: features that come to s d from d have moved by (1 - s) d together
/// (docs/features.md). Where each vertex has a radius, not half a distance but the largest radius of its own vertices.
struct Inflation {
    float half = 0, of_way = 0;
    bool of_box = false;  ///< what is widened is the box of a primitive's points, along the axes of the coordinates
    const float* radius = nullptr;  ///< one a primitive, instead of `half`, the largest of them; or null

    CRUMPLE_HD bool none() const { return half == 0 && of_way == 0 && !of_box; }
    /// That of one primitive.
    CRUMPLE_HD Inflation of(std::int64_t primitive) const {
        return {radius ? radius[primitive] : half, of_way, of_box, nullptr};
    }
    /// Of a primitive whose corners move by so much. Rounded up; coordinates are at most 1, so no more than `farthest`
    /// matters.
    CRUMPLE_HD float operator()(float way) const {
        return min(farthest, (half + of_way * (way + lost_way)) * 1.000002f);
    }
};

}  // namespace crumple
