#pragma once

#include <string>

#include "crumple/io.h"

namespace crumple::io {

/// Throws Error (invalid_argument, index_out_of_range, not_finite) unless shapes are sound, every body has one of them,
/// and poses are finite.
void validate(const WorldMesh& world);

/// The first float32 body that its pose takes more than 1024 times its size away from the origin, where float32 rounds
/// its vertices by up to a 16,384th of its size; null if there is none.
const NamedBody* find_far_body(const WorldMesh& world);

/// One body in place.
WorldMesh world_of(const TriangleMesh& mesh, std::string name = "mesh");

}  // namespace crumple::io
