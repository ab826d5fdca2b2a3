#pragma once

// A share of the answer by the ids of its triangles: what one block of a stream holds (stream.h).

#include <cstdint>

#include "crumple/array.h"
#include "engine/cpu/layout.h"
#include "engine/cpu/parallel.h"
#include "model/levels.h"

namespace crumple::cpu {

/// Ids [begin, end), in joint numbering.
struct IdRange {
    std::int64_t begin = 0, end = 0;
    std::int64_t size() const { return end - begin; }
};

/// Pairs whose lower id is in `first` and whose higher id is in `first` or `second`.
struct PairRange {
    IdRange first, second;
};

/// Leaves out (included[t] = 0) the triangles that are in no pair of the range: those of neither list of ids, and those
/// of the second alone that do not reach the box of the first. Returns a level that owns the pairs of the range among
/// what is left. It has two clusters: triangles of the first list are members of cluster 1 alone, all others of both,
/// so that 0 owns a pair of two others, and 1, the range, all the rest. The masks are its own.
Level exclude_others(const PairRange& range, Workers& workers, const Array<Ball>& balls, Array<std::uint8_t>& included,
                     Array<std::uint64_t>& masks);

}  // namespace crumple::cpu
