#pragma once

// What can be said about a mesh before any collision: how it hangs together and what is odd about it.

#include <cstdint>
#include <vector>

#include "crumple/io.h"

namespace crumple::cli {

/// Numbers the connected components of triangles that share vertices by index, from 0 in the order of their first
/// triangles, and returns how many there are. `labels` has one entry a triangle.
std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels);

struct EdgeCounts {
    std::int64_t open = 0;          ///< edges of one triangle
    std::int64_t non_manifold = 0;  ///< edges of three or more
};
/// An edge joins two different vertices, by index, in either direction.
EdgeCounts count_edges(const io::TriangleMesh& mesh);

/// Triangles whose corners lie on one line or in one point, decided exactly.
std::vector<std::int32_t> degenerate_triangles(const io::TriangleMesh& mesh);

/// Triangles whose three corners are at the positions of an earlier triangle's, in any order; each but the first.
std::vector<std::int32_t> duplicated_triangles(const io::TriangleMesh& mesh);

}  // namespace crumple::cli
