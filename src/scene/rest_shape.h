#pragma once

// Rest shape of a scene: queries about nearness drop features that are close to each other in it.

#include <cstdint>

#include "scene/prepared_scene.h"

namespace crumple {

struct RestShape {
    VertexReader position;  ///< rest positions of the scene's vertices
    /// Body of each vertex, or -1 if it has no rest shape; null: all are of one body.
    const std::int32_t* body = nullptr;
    double radius = 0;

    /// True if features with these vertices have a distance in the rest shape: both are of one body that has one.
    bool knows(std::int32_t v, std::int32_t w) const { return !body || (body[v] >= 0 && body[v] == body[w]); }
};

}  // namespace crumple
