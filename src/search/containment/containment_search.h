#pragma once

// Answers intersection queries with containment on any backend that runs on the host: bodies whose surfaces meet, by
// the search of worlds, and those of which one has a component inside the other.

#include "search/containment/closed_bodies.h"
#include "search/world_search.h"

namespace crumple {

/// `worlds` finds the surfaces that meet; `bodies` keeps the surfaces of shapes between calls.
void find_with_containment(BackendBase& backend, WorldSearch& worlds, ClosedBodies& bodies, const World& world,
                           const IntersectionQuery& query, MemoryMeter& meter, Cancellation& cancellation,
                           Intersections& result);

}  // namespace crumple
