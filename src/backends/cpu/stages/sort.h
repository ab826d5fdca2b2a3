#pragma once

// Stage `sort`: sorts a leaf's members by the start of their interval along the sweep direction ([MZ] sec. 3).
//
// Only boxes are sorted here. A query scatters its own records, by SortedLeaf::position.
//
// Boxes are quantised to 16 bits over the leaf's range, and starts are sorted by their upper ten bits: a counting sort
// of 1,024 bins, one pass. A row's columns are then all members up to the bin that holds its end; members of one bin
// may stand in any order, since only `end` decides. Rounding starts and ends by the same monotone map keeps every
// overlap.

#include "backends/cpu/stages/kernels.h"
#include "backends/cpu/stages/leaf_members.h"

namespace crumple::cpu {

/// Scratch of `sort`, one per worker.
struct SortScratch {
    explicit SortScratch(MemoryMeter* m) : box(m), sorted_box(m) {}
    Array<QuantisedBox> box;
    Array<RowBox> sorted_box;
};

/// Sizes the arrays for a leaf with this number of members.
void reserve(std::int64_t members, bool between, SortScratch& scratch, SortedLeaf& sorted);

void sort_leaf(const LeafMembers& members, const StageKernels& kernels, SortScratch& scratch, SortedLeaf& sorted);

}  // namespace crumple::cpu
