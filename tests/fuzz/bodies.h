#pragma once

// Checks of worlds and poses that were read: they are valid, and survive writing and reading again.

#include <span>
#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::fuzz {

/// Requires valid shapes, bodies that refer to one of them, unique names and finite poses.
void require_sound(const io::WorldMesh& world);

/// Requires `world` to be `before` after welding: the same bodies, shapes with corners at the same positions, and no
/// two vertices of a shape at one position.
void require_welded(const io::WorldMesh& world, const io::WorldMesh& before);

/// Writes the world as .glb and reads it. Requires bodies with triangles to keep their names and, if their shapes are
/// float32, their poses and corners.
void require_kept_by_writer(const io::WorldMesh& world);

/// Requires finite poses, a multiple of the number of bodies. Requires that they do not change when they are written,
/// as text and as .npy, and read.
void require_kept(const std::vector<Pose>& poses, std::span<const std::string> bodies);

}  // namespace crumple::fuzz
