#pragma once

// What a mesh or a list of pairs that was read must be, and become when it is written and read again.

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::fuzz {

/// The same precision, bits, triangles and groups.
void require_same(const io::TriangleMesh& a, const io::TriangleMesh& b, const char* what);

/// The same precision, and the same corners in the same order, whatever vertices they name.
void require_same_corners(const io::TriangleMesh& a, const io::TriangleMesh& b, const char* what);

/// Whole triangles, indices in range, finite coordinates, no groups or one a triangle.
void require_sound(const io::TriangleMesh& mesh);

/// No two vertices at one position, and the same corners as the mesh before welding.
void require_welded(const io::TriangleMesh& mesh, const io::TriangleMesh& before);

/// Written by each writer and read again, a mesh is the same as far as the format can hold it. Coloured meshes keep
/// their polygons, to be cut as they were.
void require_kept_by_writers(const io::TriangleMesh& mesh, io::Triangulation triangulation);

/// The same for pairs, which all formats hold.
void require_kept_by_writers(const std::vector<Pair>& pairs);

}  // namespace crumple::fuzz
