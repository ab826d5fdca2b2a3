#pragma once

// Memory that the stages of the cpu backend reuse from call to call. The stages own nothing; order.cpp passes them what
// they need.

#include <memory>
#include <vector>

#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/leaf_members.h"
#include "backends/cpu/stages/sort.h"
#include "backends/cpu/stages/subdivide.h"
#include "crumple/intersections.h"

namespace crumple::cpu {

/// Memory of one worker, for one leaf at a time, from `align` to `sweep`. A leaf is a small set of triangles that one
/// sweep searches.
struct WorkerBuffers {
    explicit WorkerBuffers(MemoryMeter* m) : members(m), sort(m), leaf(m), tile_begin(m) {}
    LeafMembers members;
    SortScratch sort;
    SortedLeaf leaf;
    Array<std::int64_t> tile_begin;  ///< first row of each tile of a large leaf, then the end
    Statistics statistics;           ///< counts and times of align and sort
};

struct Buffers {
    Buffers(MemoryMeter* m, int workers) : points(m), balls(m), subdivision(m), included(m) {
        for (int w = 0; w < workers; ++w) worker.push_back(std::make_unique<WorkerBuffers>(m));
    }

    const std::uint8_t* included_or_null() const { return included.empty() ? nullptr : included.data(); }

    Points points;
    Array<Ball> balls;
    Subdivision subdivision;
    Array<std::uint8_t> included;  ///< by triangle: 0 if it is left out; empty if none is left out
    bool repeats_corner = false;   ///< true if some triangle has a repeated vertex
    WarmCentres warm;
    std::vector<std::unique_ptr<WorkerBuffers>> worker;
};

}  // namespace crumple::cpu
