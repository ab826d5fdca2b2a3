#pragma once

// What the cpu backend owns and keeps from call to call. The stages own nothing; order.cpp hands them what they need.

#include <memory>
#include <vector>

#include "engine/cpu/copies.h"
#include "engine/cpu/layout.h"
#include "engine/cpu/leaf_members.h"
#include "engine/cpu/output.h"
#include "engine/cpu/sort.h"
#include "engine/cpu/subdivide.h"
#include "model/rules.h"
#include "questions/intersect/cpu/narrow.h"

namespace crumple::cpu {

/// Memory of one worker: a leaf on its way from `align` to `narrow`, and what was found.
struct WorkerBuffers {
    explicit WorkerBuffers(MemoryMeter* m) : members(m), sort(m), leaf(m), records(m), tile_begin(m), narrow(m) {}
    LeafMembers members;
    SortScratch sort;
    SortedLeaf leaf;
    LeafRecords records;
    Array<std::int64_t> tile_begin;  ///< rows at which a large leaf is cut
    NarrowScratch narrow;
};

struct Buffers {
    Buffers(MemoryMeter* m, int workers)
        : rule(m), points(m), balls(m), subdivision(m), included(m), range_masks(m), copies(m), output(m) {
        for (int w = 0; w < workers; ++w) {
            worker.push_back(std::make_unique<WorkerBuffers>(m));
            found.push_back(&worker.back()->narrow.pairs);
        }
    }

    const std::uint8_t* included_or_null() const { return included.empty() ? nullptr : included.data(); }

    GroupRule rule;
    Points points;
    Array<Ball> balls;
    Subdivision subdivision;
    Array<std::uint8_t> included;      ///< by triangle: 0 for one that is left out; empty: none is
    Array<std::uint64_t> range_masks;  ///< by triangle: see exclude_others()
    bool repeats_corner = false;       ///< whether some triangle names a vertex twice
    Copies copies;
    OutputScratch output;
    WarmCentres warm;
    std::size_t pairs_before = 0;  ///< pairs of the call before
    std::vector<std::unique_ptr<WorkerBuffers>> worker;
    std::vector<const Array<Pair>*> found;  ///< the pairs of each worker
};

}  // namespace crumple::cpu
