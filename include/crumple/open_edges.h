#pragma once

#include <cstdint>

#include "crumple/array.h"
#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/mesh.h"

namespace crumple {

/// Edge that occurs in its triangles more often in one direction than in the other. This includes an edge with only one
/// triangle, and an edge that two triangles traverse in the same direction.
struct OpenEdge {
    Edge edge;
    std::int32_t triangle;  ///< lowest index of a triangle with this edge
    friend bool operator==(const OpenEdge&, const OpenEdge&) = default;
};

/// Lists the open edges of a mesh in host memory, in lexicographic order. A surface without any is closed, as an
/// OverlapQuery needs it (docs/overlap.md). `weld`: merges vertices at equal positions; results name the one with the
/// lowest index. Throws Error (invalid_argument, index_out_of_range, not_finite). Cost: O(n log n), on one thread.
CRUMPLE_API Array<OpenEdge> open_edges(const MeshView& mesh, bool weld = false);

}  // namespace crumple
