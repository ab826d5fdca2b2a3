#pragma once

// Woven sheet before simulation: its points in the plane and its triangles.

#include <array>
#include <cstdint>
#include <vector>

#include "scenes/random.h"

namespace crumple::scenes {

struct Fabric {
    using Corners = std::array<std::int32_t, 3>;

    double spacing = 0;                       ///< distance between adjacent points along warp and weft
    std::vector<std::array<double, 2>> flat;  ///< (u, v) of each point; warp runs along u, weft along v
    std::vector<Corners> triangles;           ///< counter-clockwise
};

/// Returns a rectangle about the origin, of `columns` by `rows` cells of width `spacing`, with 2 * columns * rows
/// triangles. Points are in the order of rows, and are displaced at random by up to a tenth of a cell; each cell has a
/// random diagonal.
Fabric weave(int columns, int rows, double spacing, Random& random);

/// Returns the number of cells along one side of a square fabric of about `triangles` triangles; at least 4.
int cells_of_square(double triangles);

}  // namespace crumple::scenes
