#pragma once

// Shells of a body: its connected components of triangles, each as a mesh of its own.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/io.h"

namespace crumple::checks {

struct ShellMesh {
    io::TriangleMesh mesh;                ///< only the vertices that its triangles name
    std::vector<std::int32_t> triangles;  ///< index in the body of each triangle
};

/// Splits a body into `count` shells. `labels`: shell of each triangle, as from label_components(). O(n).
std::vector<ShellMesh> split_into_shells(const io::TriangleMesh& mesh, std::span<const std::int32_t> labels,
                                         std::int32_t count);

}  // namespace crumple::checks
