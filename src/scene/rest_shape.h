#pragma once

// Where a scene's vertices are at rest: what is close there is no answer to a question about nearness.

#include <cstdint>

#include "scene/prepared_scene.h"

namespace crumple {

struct RestShape {
    VertexReader position;               ///< of the scene's vertices
    const std::int32_t* body = nullptr;  ///< of each vertex, or -1: it has no rest shape; null: all are of one body
    double radius = 0;

    /// Whether two features, of each of which this is a vertex, have a distance at rest.
    bool knows(std::int32_t v, std::int32_t w) const { return !body || (body[v] >= 0 && body[v] == body[w]); }
};

}  // namespace crumple
