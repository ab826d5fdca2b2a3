#pragma once

// Holes of a surface: connected components of its open edges.

#include <cstdint>
#include <span>
#include <vector>

#include "checks/body_report.h"

namespace crumple::checks {

/// Connected component of open edges: usually a closed curve around a hole.
struct BoundaryLoop {
    std::vector<Edge> edges;
    double length = 0;
    Point centre{};  ///< centroid of the curve; if the length is 0, one of its points
    BoundingBox box{};
};

/// Returns the components in the order of their lowest vertices. `open`: the edges that belong to one triangle only.
/// O(n log n).
std::vector<BoundaryLoop> find_boundary_loops(const io::TriangleMesh& mesh, std::span<const Edge> open);

}  // namespace crumple::checks
