#pragma once

// Decides if a pose turns bodies inside out. Host only.

#include "exact/integer.h"
#include "scene/placement.h"

namespace crumple {

/// Returns −1 for a pose that mirrors, 0 for one that flattens, else 1; decided exactly.
inline int orientation_of(const Placement& placement) {
    if (placement.identity()) return 1;
    const Affine pose = placement.matrix();
    const std::array<Vec3d, 3> columns{pose.column(0), pose.column(1), pose.column(2)};
    const int exponent = common_exponent(columns);
    return dot(scaled(columns[0], exponent), cross(scaled(columns[1], exponent), scaled(columns[2], exponent))).sign();
}

}  // namespace crumple
