#pragma once

// What a world or poses that were read must be, and become when they are written and read again.

#include <span>
#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::fuzz {

/// Sound shapes, bodies that have one of them, names once each, finite poses.
void require_sound(const io::WorldMesh& world);

/// The same bodies over shapes with the same corners, and no two vertices at one position.
void require_welded(const io::WorldMesh& world, const io::WorldMesh& before);

/// Written as .glb and read again, bodies with triangles are the same: names, poses, and shapes of float32.
void require_kept_by_writer(const io::WorldMesh& world);

/// Finite numbers, whole configurations, and the same poses when they are written as text and as NumPy's array.
void require_kept(const std::vector<Pose>& poses, std::span<const std::string> bodies);

}  // namespace crumple::fuzz
