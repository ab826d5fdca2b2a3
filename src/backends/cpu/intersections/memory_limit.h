#pragma once

// Search under a memory limit. First-level clusters are searched one after another, on one worker, and all of them
// twice: the first pass counts the pairs of each triangle, the second one writes the pairs to their places in the
// result. So no list of pairs is stored besides the result, and only one cluster's members and records are stored at a
// time.

#include "backends/cpu/intersections/find_intersections.h"

namespace crumple::cpu {

/// Finds the same result as find(), in as little memory as possible. Throws MemoryMeter::Exceeded, or ResultExceeds, if
/// even this exceeds the limit.
void find_in_chunks(IntersectCall call, Intersections& result);

}  // namespace crumple::cpu
