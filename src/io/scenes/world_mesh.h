#pragma once

#include <string>

#include "crumple/io.h"

namespace crumple::io {

/// Throws Error (invalid_argument, index_out_of_range, not_finite) unless all shapes are valid, the shape index of
/// every body is in range, and poses are finite.
void validate(const WorldMesh& world);

/// Returns the first float32 body whose pose moves it away from the origin by more than 1024 times its size, or null.
/// At that distance, rounding to float32 moves vertices by up to 1/16,384 of the body's size.
const NamedBody* find_far_body(const WorldMesh& world);

/// Moves the shapes and bodies of a world to the end of another one, whose unit it sets if that is unknown.
void append(WorldMesh&& more, WorldMesh& all);

/// Returns a world of one body with the identity pose.
WorldMesh world_of(const TriangleMesh& mesh, std::string name = "mesh");

}  // namespace crumple::io
