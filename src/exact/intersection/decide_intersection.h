#pragma once

// Decides exactly if a pair of triangles collides, as docs/contract.md defines it, on the host: by
// intersection_decision.h, and by rational arithmetic for coordinates beyond its range.

#include <cstdint>

#include "crumple/intersections.h"
#include "geometry/triangle.h"

namespace crumple {

/// Number of decisions that reached each stage; summed into Statistics.
struct DecisionCounts {
    std::int64_t exact = 0;     ///< pairs unresolved by float64 filters
    std::int64_t rational = 0;  ///< of these, pairs beyond the range of expansions (geometry/predicates.h)
};

/// True iff the pair collides under `neighbours` and `intersections`. Needs round-to-nearest without flush-to-zero.
/// Cost: about 100 ns where float64 decides, 1 us with expansions, tens of us with rationals.
bool collide(const Triangle& a, const Triangle& b, Neighbours neighbours, IntersectionKind intersections,
             DecisionCounts& counts);

}  // namespace crumple
