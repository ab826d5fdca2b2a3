#pragma once

// Decides exactly if a pair of triangles collides, as the contract defines it (docs/narrow.md), on the host: by
// intersection_decision.h, and by rational arithmetic for coordinates beyond its range.

#include <cstdint>

#include "crumple/intersections.h"
#include "geometry/triangle.h"

namespace crumple {

/// Number of decisions that reached each stage; summed into Statistics.
struct DecisionCounts {
    std::int64_t exact = 0;     ///< unresolved by float64 filters
    std::int64_t rational = 0;  ///< number of `exact` beyond the range of expansions
};

/// True iff the pair collides under the policies. Needs round-to-nearest without flush-to-zero.
/// Cost: about 100 ns where float64 decides, 1 us with expansions, tens of us with rationals.
bool collide(const Triangle& a, const Triangle& b, Neighbours neighbours, IntersectionKind intersections,
             DecisionCounts& counts);

}  // namespace crumple
