#pragma once

// What happens under a memory limit: first-level clusters one after another, on one worker, and twice: pairs are
// counted, then written to their places ([MZ] sec. 3.1's use of prefix sums). Nothing is stored but records and the
// result.

#include "backends/cpu/intersections/find_intersections.h"

namespace crumple::cpu {

/// As find(), in as little memory as may be. Throws MemoryMeter::Exceeded, or ResultExceeds, if that is too much.
void find_in_chunks(IntersectCall call, Intersections& result);

}  // namespace crumple::cpu
