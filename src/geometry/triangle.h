#pragma once

#include <array>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// The exact input of a decision: three points in float64 (float32 input converts without loss) and the ids of the
/// vertices they came from. Equal ids are the same vertex; [a, a, b] names two.
struct Triangle {
    std::array<Vec3d, 3> point;
    std::array<std::int32_t, 3> vertex;
};

}  // namespace crumple
