#pragma once

// Random triangles and directions for tests of withdrawals.

#include "exact/overlap/face_crossing.h"
#include "worlds/random_worlds.h"

namespace crumple::test {

inline Vec3d grid_point(Dice& dice, int n) {
    return {double(dice.below(n)), double(dice.below(n)), double(dice.below(n))};
}
inline Vec3d point_between(Dice& dice, double low, double high) {
    return {dice.between(low, high), dice.between(low, high), dice.between(low, high)};
}

inline FaceCorners random_triangle(Dice& dice, bool grid) {
    FaceCorners p;
    for (Vec3d& corner : p) corner = grid ? grid_point(dice, 4) : point_between(dice, 0, 1);
    if (dice.chance(0.1)) p[1] = p[0];
    if (dice.chance(0.1)) p[2] = 0.5 * p[0] + 0.5 * p[1];
    if (dice.chance(0.2)) p[0].z = p[1].z = p[2].z = 1;  // coplanar with others
    return p;
}

/// Returns a direction: along an axis, along an edge, in the plane of the triangle, or any other.
inline Vec3d random_direction(Dice& dice, const FaceCorners& p, bool grid) {
    Vec3d d{};
    switch (dice.below(5)) {
        case 0:
            d[dice.below(3)] = dice.chance(0.5) ? 1 : -2;
            break;
        case 1:
            d = p[1] - p[0];
            break;
        case 2:
            d = 2.0 * p[2] - p[0] - p[1];
            break;
        default:
            d = grid ? grid_point(dice, 5) - Vec3d{2, 2, 2} : point_between(dice, -1, 1);
    }
    return d == Vec3d{} ? Vec3d{0, 0, 1} : d;
}

}  // namespace crumple::test
