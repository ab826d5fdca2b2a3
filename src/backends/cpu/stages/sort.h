#pragma once

// Stage `sort`: sorts the members of a leaf (small set of triangles that one sweep searches) by the start of their
// interval along the sweep direction (sec. 3 of [MZ], the paper cited in ARCHITECTURE.md).
//
// Only boxes are sorted here. A query scatters its own records, by SortedLeaf::position.
//
// Boxes are quantised to 16 bits over the leaf's range, and starts are sorted by their upper ten bits: a counting sort
// of 1,024 bins, one pass. A row's columns, the members that the sweep tests it with, are then all later rows up to the
// bin that contains the end of its interval. Two meshes are sorted separately, and the columns are rows of the other
// mesh: from the bin of the interval's start on or, for a row of the second mesh, from the next bin on. Members of one
// bin may have any order, because a row's columns depend on bins only. Rounding starts and ends by the same monotone
// map keeps every overlap.

#include "backends/cpu/stages/kernels.h"
#include "backends/cpu/stages/leaf_members.h"

namespace crumple::cpu {

/// Scratch of `sort`, one per worker.
struct SortScratch {
    explicit SortScratch(MemoryMeter* m) : box(m), sorted_box(m) {}
    Array<QuantisedBox> box;
    Array<RowBox> sorted_box;
};

/// Sizes the arrays for a leaf with this number of members. `between`: true if the scene is two meshes.
void reserve(std::int64_t members, bool between, SortScratch& scratch, SortedLeaf& sorted);

void sort_leaf(const LeafMembers& members, const StageKernels& kernels, SortScratch& scratch, SortedLeaf& sorted);

}  // namespace crumple::cpu
