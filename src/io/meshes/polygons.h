#pragma once

// Polygons that the triangles of a mesh were cut from. In a mesh without polygons, each triangle counts as one.

#include <vector>

#include "crumple/io.h"

namespace crumple::io {

std::int64_t polygon_count(const TriangleMesh& mesh);
std::int32_t polygon_of(const TriangleMesh& mesh, std::int32_t triangle);

/// Returns hit flags per triangle, from flags per triangle or per polygon.
std::vector<std::uint8_t> hit_triangles(const TriangleMesh& mesh, const Array<std::uint8_t>& hit);

}  // namespace crumple::io
