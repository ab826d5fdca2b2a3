#pragma once

// Records of the members of a leaf (small set of triangles that one sweep searches) from `align` to `narrow`: as built,
// and at their rows once the boxes are sorted.

#include "backends/cpu/intersections/intersection_kernels.h"
#include "backends/cpu/intersections/vertex_stars.h"
#include "backends/cpu/stages/leaf_members.h"

namespace crumple::cpu {

struct LeafRecords {
    explicit LeafRecords(MemoryMeter* m) : built(m), sorted(m), stars(m) {}
    Array<Record> built;   ///< in the order of LeafMembers
    Array<Record> sorted;  ///< by physical row (stages/layout.h), with planes times plane_scale()
    float reach = 0;       ///< the leaf's largest |coordinate|
    VertexStars stars;     ///< pairs of adjacent members that the sweep does not list

    /// Reserves memory for a leaf with these numbers of members and, with dummies, of rows.
    void reserve(std::int64_t members, std::int64_t rows) {
        built.resize_discard(static_cast<std::size_t>(members + padding));
        sorted.resize_discard(static_cast<std::size_t>(rows + padding));
    }

    /// Completes `align`: computes records and boxes of a leaf's members, and finds stars.
    void build(const IntersectKernels& kernels, const BuildInput& input, LeafMembers& members);

    /// Completes `sort`: copies each record to its member's row.
    void sort(const IntersectKernels& kernels, const SortedLeaf& leaf);
};

}  // namespace crumple::cpu
