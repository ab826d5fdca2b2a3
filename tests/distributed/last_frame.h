#pragma once

// Procedural scenes, small enough for many ranks to make them one after the other.

#include <cstdint>

#include "distributed/shares.h"
#include "scenes/scenes.h"

namespace crumple::test {

/// The last frame of a scene of about so many triangles. A simulated one takes all frames before it, so it has 500:
/// with fewer, some collide no more.
inline WholeMesh last_frame(const scenes::Description& scene, std::int64_t triangles) {
    if (scene.simulated) triangles = 500;
    return WholeMesh(scenes::make(scene.name, {.triangles = triangles, .frame = scene.frames - 1}));
}

}  // namespace crumple::test
