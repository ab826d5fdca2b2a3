#pragma once

// Shell that is cut along the curves in which it crosses itself, into patches: connected pieces of the surface that are
// not connected across these curves. In float64, not exactly.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "checks/crossing_places.h"
#include "crumple/io.h"
#include "io/coloured/cut_triangle.h"

namespace crumple::checks {

struct CutShell {
    /// Convex piece of a triangle.
    struct Piece {
        std::int32_t triangle;
        std::int32_t patch;  ///< patches are numbered from 0
        io::CutPiece corners;
    };
    struct Patch {
        std::vector<std::int32_t> pieces;
        std::int32_t winding_outside =
            0;  ///< winding number of the shell on the outer side; the inner side has one more
        std::vector<std::int32_t> places = {};  ///< places of curves at its border, ascending
    };

    std::vector<Vec3d> points;  ///< the shell's vertices, then corners of pieces
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<Piece> pieces;  ///< by triangle
    std::vector<Patch> patches;
    double tolerance = 0;  ///< lengths below this count as 0
};

/// Cuts a closed shell. `places`: those in which it meets itself. Returns nothing if more than 1,000 other triangles
/// cross one triangle. O(n log n) for n triangles, plus the square of the number of pieces of each triangle.
std::optional<CutShell> cut_shell(const io::TriangleMesh& shell, const Intersections& found,
                                  std::span<const CrossingPlace* const> places);

}  // namespace crumple::checks
