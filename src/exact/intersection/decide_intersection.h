#pragma once

// The exact decision whether a pair of triangles collides, by the contract's words (docs/narrow.md), for the host:
// intersection_decision.h, and rational arithmetic for what lies beyond its range.

#include <cstdint>

#include "crumple/intersections.h"
#include "geometry/triangle.h"

namespace crumple {

/// How far a decision had to go; summed into Statistics.
struct DecisionCounts {
    std::int64_t exact = 0;     ///< float64 filters left it undecided
    std::int64_t rational = 0;  ///< of these, expansions could not hold it
};

/// True iff the pair collides under the policies. Needs round-to-nearest without flush-to-zero.
/// Cost: about 100 ns where float64 decides, 1 us with expansions, tens of us with rationals.
bool collide(const Triangle& a, const Triangle& b, Neighbours neighbours, IntersectionKind intersections,
             DecisionCounts& counts);

}  // namespace crumple
