#pragma once

// What the stages of the cpu backend keep from call to call. They own nothing; order.cpp hands them what they need.

#include <memory>
#include <vector>

#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/leaf_members.h"
#include "backends/cpu/stages/sort.h"
#include "backends/cpu/stages/subdivide.h"
#include "crumple/intersections.h"

namespace crumple::cpu {

/// Memory of one worker: a leaf on its way from `align` to `sweep`.
struct WorkerBuffers {
    explicit WorkerBuffers(MemoryMeter* m) : members(m), sort(m), leaf(m), tile_begin(m) {}
    LeafMembers members;
    SortScratch sort;
    SortedLeaf leaf;
    Array<std::int64_t> tile_begin;  ///< rows at which a large leaf is cut
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
    Array<std::uint8_t> included;  ///< by triangle: 0 for one that is left out; empty: none is
    bool repeats_corner = false;   ///< whether some triangle names a vertex twice
    WarmCentres warm;
    std::vector<std::unique_ptr<WorkerBuffers>> worker;
};

}  // namespace crumple::cpu
