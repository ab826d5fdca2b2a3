#pragma once

// Checks of worlds and poses that were read: they are valid, and survive writing and reading again.

#include <span>
#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::fuzz {

/// Requires valid shapes, bodies that refer to one of them, unique names and finite poses.
void require_sound(const io::WorldMesh& world);

/// Requires the bodies of `before` over shapes with the same corners, and no two vertices at one position.
void require_welded(const io::WorldMesh& world, const io::WorldMesh& before);

/// Requires bodies with triangles to survive writing as .glb and reading: names, and for float32 shapes poses and
/// corners.
void require_kept_by_writer(const io::WorldMesh& world);

/// Requires finite poses and whole configurations, which survive writing as text and as .npy and reading.
void require_kept(const std::vector<Pose>& poses, std::span<const std::string> bodies);

}  // namespace crumple::fuzz
