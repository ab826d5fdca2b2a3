#pragma once

// Woven sheet before simulation: its points in the plane and its triangles.

#include <array>
#include <cstdint>
#include <vector>

#include "scenes/random.h"

namespace crumple::scenes {

struct Fabric {
    using Corners = std::array<std::int32_t, 3>;

    double spacing = 0;                       ///< between adjacent points
    std::vector<std::array<double, 2>> flat;  ///< (u, v) of each point; warp runs along u, weft along v
    std::vector<Corners> triangles;           ///< counter-clockwise
};

/// Returns a rectangle about the origin, `columns` by `rows` cells of width `spacing`, points moved by up to a tenth of
/// a cell, diagonals drawn at random: 2 columns rows triangles, points row by row.
Fabric weave(int columns, int rows, double spacing, Random& random);

/// Returns the number of cells along one side of a square fabric of about that many triangles, at least 4.
int cells_of_square(double triangles);

}  // namespace crumple::scenes
