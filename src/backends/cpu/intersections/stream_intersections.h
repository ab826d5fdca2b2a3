#pragma once

// Answers that exceed memory: handed over in blocks, each of which has room.
//
// In order: a block has all pairs whose first triangle is in a range of ids. Their number is not known beforehand,
// so a range is searched until one pair more than a block was found, and then again by half; the ranges that follow
// have the length that the last block suggests. Bounds are computed once, the rest once for each range.
//
// As found: all is searched once, and a block is handed over whenever one is full.

#include "backends/backend.h"
#include "backends/cpu/intersections/find_intersections.h"

namespace crumple::cpu {

/// Hands all pairs over, at most `most` in a block, in order.
void stream_in_order(IntersectCall call, std::int64_t most, BlockSink sink);

/// The same in any order, by whichever worker has filled a block, one at a time.
void stream_as_found(IntersectCall call, std::int64_t most, BlockSink sink);

}  // namespace crumple::cpu
