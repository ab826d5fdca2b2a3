#pragma once

// The exact answer for two bodies that do not meet, once a search has left few pairs of triangles. Host only.

#include <cstdint>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "exact/distance/closest_parts.h"
#include "exact/distance/rational_nearest.h"

namespace crumple {

/// Two triangles that do not intersect, and may be the closest ones.
struct NearestCandidate {
    Pair triangles;
    TrianglePoints a, b;
    double lower;  ///< their distance is at least this
};

/// The least distance, the first pair of triangles that has it, and where they are closest.
struct LeastDistance {
    double squared = 0;  ///< rounded to the nearest number
    bool within = false;
    Pair triangles{};
    Witnesses points;
};

/// `candidates`, at least one, in any order, among them all pairs of triangles whose distance is the least one; they
/// are sorted. `upper`: the least distance is at most this, or more than the radius, and then not `within`; all else is
/// then of no meaning. `closest`: the candidate that seems to be the closest. `radius`: 0 or more, or infinite. Counts
/// in `rational` the pairs that take rational arithmetic.
LeastDistance decide_nearest(Array<NearestCandidate>& candidates, const NearestCandidate& closest, double upper,
                             double radius, std::int64_t& rational);

}  // namespace crumple
