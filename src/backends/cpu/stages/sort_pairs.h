#pragma once

// Pairs of indices that the workers found, in any order, become one sorted list.
//
// First indices are cut into buckets of 1,024 to 4,096; pairs go to their bucket, as one number each that tells the
// rest (of 32 bits, mostly), and each bucket is sorted alone, in a few stable counting passes: by the digits of the
// second index, then by the first one, which yields the offsets as well. Parallel over pieces of the workers' lists,
// then over buckets.

#include <span>

#include "backends/cpu/parallel.h"
#include "crumple/function_ref.h"
#include "crumple/intersections.h"

namespace crumple::cpu {

struct PairSorting {
    explicit PairSorting(MemoryMeter* m) : pieces(m), histogram(m), begin(m), keys32(m), keys64(m) {}
    Array<std::span<const Pair>> pieces;  ///< of the workers' lists
    Array<std::int64_t> histogram;        ///< pairs by piece and bucket
    Array<std::int64_t> begin;            ///< first pair of each bucket
    Array<std::uint32_t> keys32;  ///< pairs by bucket, then scratch; where 32 bits hold all that a bucket leaves open
    Array<std::uint64_t> keys64;  ///< elsewhere
};

struct PairCounts {
    std::int32_t firsts, seconds;     ///< indices are below these
    std::int32_t before_seconds = 0;  ///< subtracted from second indices
    bool frugal = false;              ///< takes as much memory whatever the number of workers
};

/// A task of its own while the buckets are sorted: one thread does it.
using Beside = FunctionRef<void(std::span<const std::span<const Pair>> found)>;

/// Sorts what is `found` into `pairs`; those of first index i are [offsets[i], offsets[i + 1]).
void sort_pairs(Workers& workers, std::span<const Array<Pair>* const> found, PairCounts counts, PairSorting& scratch,
                Array<Pair>& pairs, Array<std::int64_t>& offsets, Beside beside);

}  // namespace crumple::cpu
