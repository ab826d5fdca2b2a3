#pragma once

// Search under a memory limit. First-level clusters are searched one after another, on one worker, and all of them
// twice: the first pass counts pairs, the second one writes them to their places (as [MZ] sec. 3.1 uses prefix sums).
// Only records and the result are stored.

#include "backends/cpu/intersections/find_intersections.h"

namespace crumple::cpu {

/// Does what find() does, in as little memory as possible. Throws MemoryMeter::Exceeded, or ResultExceeds, if that
/// exceeds the limit.
void find_in_chunks(IntersectCall call, Intersections& result);

}  // namespace crumple::cpu
