#pragma once

#include "base/cancellation.h"
#include "crumple/distances.h"

namespace crumple {

/// Finds distances of bodies by brute force: for each pair of bodies, computes the distances of all pairs of triangles
/// that the pair filter keeps, in rational arithmetic. Shares the reading of worlds, the poses and the pair filter with
/// the other backends.
void find_nearest_by_brute_force(const World& world, const DistanceQuery& query, MemoryMeter& meter,
                                 Cancellation& cancellation, Distances& answer);

}  // namespace crumple
