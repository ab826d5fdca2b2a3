#pragma once

// Facts about a mesh before any collision: how it hangs together and what is odd about it.

#include <cstdint>
#include <optional>
#include <vector>

#include "crumple/io.h"

namespace crumple::cli {

/// Numbers the connected components of triangles that share vertices by index, from 0 in the order of their first
/// triangles, and returns how many there are. `labels` has one entry a triangle.
std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels);

/// Two triangles that run along an edge in the same direction.
struct FlippedEdge {
    Edge edge;
    std::int32_t first, second;
};
/// An edge joins two different vertices, by index, in either direction.
struct EdgeReport {
    std::vector<Edge> open;         ///< edges of one triangle, in lexicographic order
    std::int64_t holes = 0;         ///< parts of the open edges that hang together: closed curves, as a rule
    std::int64_t non_manifold = 0;  ///< edges of three triangles or more
    bool closed = true;             ///< every edge has an even number of triangles
    /// First edge with an even number of triangles of which more run along it in one direction than in the other; none
    /// if the orientation is consistent.
    std::optional<FlippedEdge> flipped;
};
EdgeReport report_edges(const io::TriangleMesh& mesh);

/// Volume of a closed mesh: a sixth of the sum of its triangles' triple products about the middle of its box. Positive
/// if triangles run anticlockwise seen from outside. The error is some 1e-16 of the sum of the products' magnitudes.
double signed_volume(const io::TriangleMesh& mesh);

/// Triangles whose corners lie on one line or in one point, decided exactly.
std::vector<std::int32_t> degenerate_triangles(const io::TriangleMesh& mesh);

/// Triangles whose three corners are at the positions of an earlier triangle's, in any order; each but the first.
std::vector<std::int32_t> duplicated_triangles(const io::TriangleMesh& mesh);

}  // namespace crumple::cli
