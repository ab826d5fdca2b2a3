#pragma once

// Polygons of a file, to which its triangles belong; without any, each triangle is one.

#include <vector>

#include "crumple/io.h"

namespace crumple::io {

std::int64_t polygon_count(const TriangleMesh& mesh);
std::int32_t polygon_of(const TriangleMesh& mesh, std::int32_t triangle);

/// Hits of triangles from those of triangles or of polygons.
std::vector<std::uint8_t> hit_triangles(const TriangleMesh& mesh, const Array<std::uint8_t>& hit);

}  // namespace crumple::io
