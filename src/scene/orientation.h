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
    const auto [x, y, z] = in_units(columns, common_exponent(columns));
    return dot(x, cross(y, z)).sign();
}

}  // namespace crumple
