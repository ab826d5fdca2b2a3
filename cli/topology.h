#pragma once

// Topology and defects of a mesh: components, edges, volume, degenerate and duplicated triangles.

#include <cstdint>
#include <optional>
#include <vector>

#include "crumple/io.h"

namespace crumple::cli {

/// Numbers the connected components of triangles that share vertices by index, from 0 in the order of their first
/// triangles, and returns their number. `labels`: 1 per triangle.
std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels);

/// Two triangles that run along an edge in the same direction.
struct FlippedEdge {
    Edge edge;
    std::int32_t first, second;
};
/// Report on the edges of a mesh. An edge joins two different vertices, by index, in either direction.
struct EdgeReport {
    std::vector<Edge> open;         ///< edges of one triangle, in lexicographic order
    std::int64_t holes = 0;         ///< connected components of the open edges: closed curves, as a rule
    std::int64_t non_manifold = 0;  ///< edges of three triangles or more
    bool closed = true;             ///< every edge has an even number of triangles
    /// First edge with an even number of triangles of which more run along it in one direction than in the other; none
    /// if the orientation is consistent.
    std::optional<FlippedEdge> flipped;
};
EdgeReport report_edges(const io::TriangleMesh& mesh);

/// Returns the volume of a closed mesh: a sixth of the sum of its triangles' triple products about the middle of its
/// box. Positive if triangles run anticlockwise seen from outside. The error is at most 2e-16 of the sum of the
/// absolute values of the six terms of each triple product. For a thin body this sum is far more than the volume.
double signed_volume(const io::TriangleMesh& mesh);

/// Returns the triangles whose corners lie on one line or in one point, decided exactly.
std::vector<std::int32_t> degenerate_triangles(const io::TriangleMesh& mesh);

/// Returns the triangles whose three corners are at the positions of an earlier triangle's, in any order.
std::vector<std::int32_t> duplicated_triangles(const io::TriangleMesh& mesh);

}  // namespace crumple::cli
