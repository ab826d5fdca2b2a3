#pragma once

// Sorts pairs of indices that the workers found, in any order, into one list.
//
// The first indices are cut into ranges (buckets) of 1,024 to 4,096 numbers. Each pair goes to its bucket, packed in
// one number, mostly of 32 bits, and each bucket is sorted by itself in a few stable counting passes: by the digits of
// the second index, then by the first index, which yields the offsets as well. Parallel over pieces of the workers'
// lists, then over buckets.

#include <span>

#include "backends/cpu/parallel.h"
#include "crumple/function_ref.h"
#include "crumple/intersections.h"

namespace crumple::cpu {

struct PairSorting {
    explicit PairSorting(MemoryMeter* m) : pieces(m), histogram(m), begin(m), keys32(m), keys64(m) {}
    Array<std::span<const Pair>> pieces;  ///< pieces of the workers' lists
    Array<std::int64_t> histogram;        ///< by piece and bucket: number of pairs, then where the next one is written
    Array<std::int64_t> begin;            ///< first pair of each bucket, then the number of pairs
    Array<std::uint32_t> keys32;          ///< packed pairs by bucket, then scratch; if 32 bits suffice
    Array<std::uint64_t> keys64;          ///< packed pairs, then scratch; if 32 bits do not suffice
};

struct PairCounts {
    std::int32_t firsts,
        seconds;  ///< exclusive upper bounds of first indices and, after the subtraction, of second ones
    std::int32_t before_seconds = 0;  ///< number that is subtracted from each second index
    bool low_memory = false;          ///< true: memory must not depend on the number of workers
};

/// Task that one thread runs while others sort the buckets. `found`: all pairs, unsorted, in pieces.
using ConcurrentTask = FunctionRef<void(std::span<const std::span<const Pair>> found)>;

/// Sorts the pairs of the workers' lists `found` into `pairs`; those with first index i are at [offsets[i],
/// offsets[i + 1]). Runs `beside` on one of the threads.
void sort_pairs(Workers& workers, std::span<const Array<Pair>* const> found, PairCounts counts, PairSorting& scratch,
                Array<Pair>& pairs, Array<std::int64_t>& offsets, ConcurrentTask beside);

}  // namespace crumple::cpu
