#pragma once

// Decides the exact distance of two bodies that do not meet, among the few pairs of triangles that a search has left.
// Host only.

#include <cstdint>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "exact/distance/closest_parts.h"
#include "exact/distance/exact_nearest.h"

namespace crumple {

/// Two triangles that do not intersect and may be the closest pair.
struct NearestCandidate {
    Pair triangles;
    TrianglePoints a, b;
    double lower;  ///< lower bound on their distance
};

/// The least distance, the first pair of triangles that has it, and their closest points.
struct LeastDistance {
    double squared = 0;   ///< rounded to the nearest float64
    bool within = false;  ///< true if the least distance is at most the radius
    Pair triangles{};
    Witnesses points;
};

/// Returns the least distance of the candidates, and sorts them. `candidates`: at least one, in any order, including
/// all pairs of triangles at the least distance. `closest`: the candidate that seems to be the closest. `upper`: an
/// upper bound on the least distance, or any number if the least distance exceeds the radius. In the latter case
/// `within` is false, and the rest of the result is undefined. `radius`: 0 or more, or infinite. Adds to `rational` the
/// number of pairs that took rational arithmetic.
LeastDistance decide_nearest(Array<NearestCandidate>& candidates, const NearestCandidate& closest, double upper,
                             double radius, std::int64_t& rational);

}  // namespace crumple
