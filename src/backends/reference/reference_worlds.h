#pragma once

#include "base/cancellation.h"
#include "crumple/world.h"
#include "results/world_output.h"

namespace crumple {

/// A world by brute force: all triangles of all bodies posed, all wanted pairs whose boxes overlap decided in rational
/// arithmetic; in blocks, if `blocks` is not null. Shares with other engines how a world is read, the pose and the
/// rules.
void find_by_brute_force(const World& world, const IntersectionQuery& question, MemoryMeter& meter,
                         Cancellation& cancellation, Intersections& result, const WorldBlocks* blocks = nullptr);

}  // namespace crumple
