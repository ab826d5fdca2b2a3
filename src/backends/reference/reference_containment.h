#pragma once

// Intersections with containment by brute force: the reference for search/containment/containment_search.h.

#include "base/cancellation.h"
#include "crumple/intersections.h"
#include "crumple/world.h"

namespace crumple {

/// Finds surfaces that meet by brute force. For two bodies whose surfaces do not meet, finds if one is inside the other
/// by a ray from each of its vertices, in exact arithmetic.
void find_with_containment_by_brute_force(const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                                          Cancellation& cancellation, Intersections& result);

}  // namespace crumple
