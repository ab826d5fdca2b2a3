#pragma once

#include <string>

#include "crumple/io.h"

namespace crumple::io {

/// Throws Error (invalid_argument, index_out_of_range, not_finite) unless shapes are sound, every body has one of them,
/// and poses are finite.
void validate(const WorldMesh& world);

/// One body in place.
WorldMesh world_of(const TriangleMesh& mesh, std::string name = "mesh");

}  // namespace crumple::io
