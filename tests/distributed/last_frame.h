#pragma once

// Procedural scenes, so small that each of many ranks can make them.

#include <cstdint>

#include "distributed/rank_meshes.h"
#include "scenes/scenes.h"

namespace crumple::test {

/// Returns the last frame of a scene with about `triangles` triangles. Simulated scenes have about 500 triangles
/// instead: more would take long, since all earlier frames are computed, and with fewer some have no collisions.
inline WholeMesh last_frame(const scenes::Description& scene, std::int64_t triangles) {
    if (scene.simulated) triangles = 500;
    return WholeMesh(scenes::make(scene.name, {.triangles = triangles, .frame = scene.frames - 1}));
}

}  // namespace crumple::test
