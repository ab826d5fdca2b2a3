#pragma once

#include <array>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// Exact input of a decision: three points in float64 (float32 input converts without loss), and the ids of their
/// vertices. Equal ids are the same vertex; [a, a, b] has two vertices.
struct Triangle {
    std::array<Vec3d, 3> point;
    std::array<std::int32_t, 3> vertex;
};

}  // namespace crumple
