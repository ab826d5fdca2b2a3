#pragma once

// Copies and removes rows of an overlap query's result, with all lists that belong to them. The table of arrays
// (overlap_arrays.h) determines which lists there are.

#include <cstdint>

#include "base/cancellation.h"
#include "crumple/function_ref.h"
#include "crumple/overlaps.h"

namespace crumple {

/// Size and consumer of the blocks of a result (Detector::stream).
struct OverlapBlocks {
    std::int64_t most;  ///< number of rows per block; the last block may have fewer
    FunctionRef<void(const Overlaps& block)> take;
};

/// Appends rows [begin, end) of a result to another one of the same query. Lists by world and by body stay unchanged.
void append_rows(const Overlaps& from, std::size_t begin, std::size_t end, Overlaps& to);

/// Delivers a whole result in blocks, each of which is made in `block`. A result without rows is one block if it has
/// lists by body, or skipped bodies.
void deliver_in_blocks(const Overlaps& whole, const OverlapBlocks& blocks, Overlaps& block, Cancellation& cancellation);

/// Replaces each body that rows name by number_of(body), which must ascend with it.
void number_bodies(Overlaps& result, FunctionRef<std::int32_t(std::int32_t body)> number_of);

/// Removes all rows; keeps lists by world and by body, and the memory.
void clear_rows(Overlaps& result);

}  // namespace crumple
