#pragma once

#include "base/cancellation.h"
#include "crumple/world.h"
#include "results/world_output.h"

namespace crumple {

/// Finds intersections in a world by brute force: poses all triangles of all bodies, and decides all pairs that the
/// filter keeps and whose boxes overlap, in rational arithmetic. Delivers blocks if `blocks` is not null. Shares the
/// reading of worlds, the poses and the pair filter with the other backends.
void find_by_brute_force(const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                         Cancellation& cancellation, Intersections& result, const WorldBlocks* blocks = nullptr);

}  // namespace crumple
