#pragma once

#include "base/cancellation.h"
#include "crumple/distances.h"

namespace crumple {

/// Distances of bodies by brute force: all wanted pairs of triangles of each pair of bodies, in rational arithmetic.
/// Shares with other engines how a world is read, the pose and the rules.
void find_nearest_by_brute_force(const World& world, const DistanceQuery& question, MemoryMeter& meter,
                                 Cancellation& cancellation, Distances& answer);

}  // namespace crumple
