#pragma once

// Rest shape of a scene: queries about nearness drop pairs of features whose distance in the rest shape is at most
// `radius`.

#include <cstdint>

#include "scene/prepared_scene.h"

namespace crumple {

struct RestShape {
    VertexReader position;  ///< rest positions of the scene's vertices
    /// Index of the body of each vertex, or -1 if that body has no rest shape; null: all vertices are of one body.
    const std::int32_t* body = nullptr;
    double radius = 0;

    /// True if features with these vertices have a distance in the rest shape: both vertices are of the same body, and
    /// it has a rest shape.
    bool knows(std::int32_t v, std::int32_t w) const { return !body || (body[v] >= 0 && body[v] == body[w]); }
};

}  // namespace crumple
