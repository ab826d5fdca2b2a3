#pragma once

#include "crumple/io.h"

namespace crumple::io {

/// Merges vertices at equal positions (-0 equals +0); the first of them stays, bit for bit. Vertices keep the order of
/// their first occurrence. A line whose ends are merged becomes a point. Takes linear time for any positions (seeded
/// hash).
void weld(TriangleMesh& mesh);

}  // namespace crumple::io
