#pragma once

// Runs intersection queries with containment: finds bodies whose surfaces meet by the search of worlds, and adds bodies
// with a component inside another one.

#include "search/containment/closed_bodies.h"
#include "search/world_search.h"

namespace crumple {

/// `worlds` finds the surfaces that meet, by `backend`; the threads of `host` find bodies inside others. `bodies`
/// caches the surfaces of shapes between calls.
void find_with_containment(BackendBase& backend, ParallelFor& host, WorldSearch& worlds, ClosedBodies& bodies,
                           const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                           Cancellation& cancellation, Intersections& result);

}  // namespace crumple
