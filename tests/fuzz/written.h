#pragma once

// Checks of meshes and lists of pairs that were read: they are valid, and survive writing and reading again.

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::fuzz {

/// Requires the same precision, triangles and groups, and bitwise equal coordinates.
void require_same(const io::TriangleMesh& a, const io::TriangleMesh& b, const char* what);

/// Requires the same precision, and corners at the same positions in the same order, whatever their vertex ids.
void require_same_corners(const io::TriangleMesh& a, const io::TriangleMesh& b, const char* what);

/// Requires whole triangles, indices in range, finite coordinates, and no groups or one per triangle.
void require_sound(const io::TriangleMesh& mesh);

/// Requires no two vertices at one position, and corners at the same positions as before welding.
void require_welded(const io::TriangleMesh& mesh, const io::TriangleMesh& before);

/// Writes the mesh in each format and reads it. Requires all that the format can store to be unchanged. Coloured meshes
/// are written with polygons, which must be cut in the same way again.
void require_kept_by_writers(const io::TriangleMesh& mesh, io::Triangulation triangulation);

/// Writes the pairs in each format and reads them. Requires the same pairs.
void require_kept_by_writers(const std::vector<Pair>& pairs);

}  // namespace crumple::fuzz
