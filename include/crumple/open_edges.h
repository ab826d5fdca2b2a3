#pragma once

#include <cstdint>

#include "crumple/array.h"
#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/mesh.h"

namespace crumple {

/// Edge that triangles name more often in one direction than in the other. An edge of one triangle is one, and so is
/// one along which two triangles run in the same direction.
struct OpenEdge {
    Edge edge;
    std::int32_t triangle;  ///< the lowest that names it
    friend bool operator==(const OpenEdge&, const OpenEdge&) = default;
};

/// Lists the open edges of a mesh in host memory, in the order of their vertices. A surface without any is closed, as
/// an OverlapQuery needs it (docs/overlap.md). `weld`: vertices at equal positions are one, the lowest of them. Throws
/// Error (invalid_argument, index_out_of_range, not_finite). Cost: O(n log n), on one thread.
CRUMPLE_API Array<OpenEdge> open_edges(const MeshView& mesh, bool weld = false);

}  // namespace crumple
