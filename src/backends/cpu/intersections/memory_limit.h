#pragma once

// What happens under a memory limit: first-level clusters one after another, on one worker, and twice: pairs are
// counted, then written to their places ([MZ] sec. 3.1's use of prefix sums). Nothing is stored but records and the
// result.

#include "backends/cpu/intersections/find_intersections.h"

namespace crumple::cpu {

/// As find(), in as little memory as may be. Throws MemoryMeter::Exceeded, or ResultExceeds, if that is too much.
void find_in_chunks(IntersectCall call, Collisions& result);

/// The number of pairs, without storing any.
std::int64_t count_in_chunks(IntersectCall call);

/// Told of the pairs of a call while it finds them; without a limit it is not needed.
PairBudget budget_of(const IntersectCall& call);

}  // namespace crumple::cpu
