#pragma once

// Topology and defects of a mesh: components, edges, volume, degenerate and duplicated triangles.

#include <cstdint>
#include <optional>
#include <vector>

#include "crumple/io.h"

namespace crumple::checks {

/// Numbers the connected components of triangles from 0, in the order of their first triangles, and returns how many
/// there are. Triangles are connected if they have a vertex index in common. Sets `labels` to the number of each
/// triangle's component.
std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels);

/// Two triangles that run along an edge in the same direction.
struct FlippedEdge {
    Edge edge;
    std::int32_t first, second;
};
/// Report on the edges of a mesh. An edge is an unordered pair of different vertex indices.
struct EdgeReport {
    std::vector<Edge> open;         ///< edges that belong to one triangle only, in lexicographic order
    std::int64_t holes = 0;         ///< number of connected components of open edges: usually closed curves
    std::int64_t non_manifold = 0;  ///< number of edges that belong to three triangles or more
    std::int64_t odd = 0;           ///< of these, number of edges that belong to an odd number of triangles
    bool closed = true;             ///< true if every edge belongs to an even number of triangles
    /// First edge with an even number of triangles that is not traversed equally often in both directions; none if the
    /// orientation is consistent.
    std::optional<FlippedEdge> flipped;
};
EdgeReport report_edges(const io::TriangleMesh& mesh);

/// Returns the volume of a closed mesh: a sixth of the sum, over all triangles, of the triple products of their corners
/// relative to the middle of the mesh's box. Positive if triangles run counter-clockwise seen from outside. The error
/// is at most 2e-16 times the sum of the absolute values of the six terms of every triple product. For a thin body this
/// sum is far larger than the volume.
double signed_volume(const io::TriangleMesh& mesh);

/// Returns the triangles whose corners lie on one line or in one point, decided exactly.
std::vector<std::int32_t> degenerate_triangles(const io::TriangleMesh& mesh);

/// Returns the triangles whose three corners are, in any order, at the same positions as those of an earlier triangle.
std::vector<std::int32_t> duplicated_triangles(const io::TriangleMesh& mesh);

}  // namespace crumple::checks
