#pragma once

#include "crumple/io.h"

namespace crumple::io {

/// Makes vertices at equal positions one (-0 equals +0): the first of them stays, with its bits. Vertices keep the
/// order of their first occurrence. Linear time, whatever the positions.
void weld(TriangleMesh& mesh);

}  // namespace crumple::io
