#pragma once

#include "crumple/io.h"

namespace crumple::fuzz {

/// Requires well-formed polygons. Each polygon of n corners is cut into n - 2 triangles with its outline. With `ears`,
/// unless a polygon of the file crosses itself, its triangles also have the same orientation as seen along some axis,
/// so that none overlaps another.
void require_cut(const io::TriangleMesh& mesh, io::Triangulation triangulation);

}  // namespace crumple::fuzz
