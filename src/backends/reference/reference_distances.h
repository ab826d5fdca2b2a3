#pragma once

#include "base/cancellation.h"
#include "crumple/distances.h"

namespace crumple {

/// Finds distances of bodies by brute force: all pairs of triangles that the filter keeps, of each pair of bodies, in
/// rational arithmetic. Shares with other engines how a world is read, the poses and the pair filter.
void find_nearest_by_brute_force(const World& world, const DistanceQuery& query, MemoryMeter& meter,
                                 Cancellation& cancellation, Distances& answer);

}  // namespace crumple
