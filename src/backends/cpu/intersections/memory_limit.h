#pragma once

// Search under a memory limit: first-level clusters run one after another, on one worker, and twice: pairs are counted,
// then written to their places (as [MZ] sec. 3.1 uses prefix sums). Only records and the result are stored.

#include "backends/cpu/intersections/find_intersections.h"

namespace crumple::cpu {

/// Does what find() does, in as little memory as possible. Throws MemoryMeter::Exceeded, or ResultExceeds, if that
/// exceeds the limit.
void find_in_chunks(IntersectCall call, Intersections& result);

}  // namespace crumple::cpu
