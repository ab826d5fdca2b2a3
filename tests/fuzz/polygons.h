#pragma once

#include "crumple/io.h"

namespace crumple::fuzz {

/// Requires well-formed polygons, and that each polygon of n corners is cut into n - 2 triangles that together have its
/// outline. With Triangulation::ears, the triangles of a polygon must also have the same orientation as seen along some
/// axis, so that none overlaps another, unless a warning says that a polygon crosses itself.
void require_cut(const io::TriangleMesh& mesh, io::Triangulation triangulation);

}  // namespace crumple::fuzz
