#pragma once

// Intersections with containment by brute force: the reference for search/containment/containment_search.h.

#include "base/cancellation.h"
#include "crumple/intersections.h"
#include "crumple/world.h"

namespace crumple {

/// Finds surfaces that meet by brute force, and bodies inside others by a rational ray from each vertex of bodies whose
/// surfaces do not meet.
void find_with_containment_by_brute_force(const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                                          Cancellation& cancellation, Intersections& result);

}  // namespace crumple
