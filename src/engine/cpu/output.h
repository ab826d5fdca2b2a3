#pragma once

// Stage `output`: the pairs that the workers found, in any order, become the sorted result.
//
// First triangles are cut into buckets of 1,024 to 4,096; pairs go to their bucket, and each bucket is sorted alone, in
// a few stable counting passes: by the digits of the second triangle, then by the first one, which yields the offsets
// as well. Parallel over pieces of the workers' lists, then over buckets.

#include <span>

#include "crumple/collisions.h"
#include "engine/cpu/parallel.h"
#include "model/scene.h"

namespace crumple::cpu {

struct OutputScratch {
    explicit OutputScratch(MemoryMeter* m) : pieces(m), histogram(m), begin(m), bucketed(m) {}
    Array<std::span<const Pair>> pieces;  ///< of the workers' lists
    Array<std::int64_t> histogram;        ///< pairs by piece and bucket
    Array<std::int64_t> begin;            ///< first pair of each bucket
    Array<Pair> bucketed;
};

/// `found[w]`: the pairs of worker w, in the joint numbering of the scene, lower id first. Fills pairs, offsets, hits.
void write_output(const Scene& scene, Workers& workers, std::span<const Array<Pair>* const> found,
                  OutputScratch& scratch, Collisions& result);

}  // namespace crumple::cpu
