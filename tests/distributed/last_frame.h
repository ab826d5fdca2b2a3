#pragma once

// Procedural scenes, small enough for many ranks to make them in turn.

#include <cstdint>

#include "distributed/shares.h"
#include "scenes/scenes.h"

namespace crumple::test {

/// Returns the last frame of a scene with about `triangles` triangles. Simulated scenes compute all earlier frames, so
/// they get 500: with fewer, some have no collisions.
inline WholeMesh last_frame(const scenes::Description& scene, std::int64_t triangles) {
    if (scene.simulated) triangles = 500;
    return WholeMesh(scenes::make(scene.name, {.triangles = triangles, .frame = scene.frames - 1}));
}

}  // namespace crumple::test
