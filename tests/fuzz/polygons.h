#pragma once

#include "crumple/io.h"

namespace crumple::fuzz {

/// Whole polygons, each cut into two triangles less than it has corners, which together have its outline; and, unless a
/// polygon of the file crosses itself, by `ears` all turned the same way as seen along some axis: none overlaps
/// another.
void require_cut(const io::TriangleMesh& mesh, io::Triangulation triangulation);

}  // namespace crumple::fuzz
