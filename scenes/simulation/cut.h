#pragma once

// Cutting a fabric along a curve: triangles that the curve crosses are split, and its two sides no longer hang
// together.
// An edge that is crossed gets a point there for either side of the cut, at the same place; where the cut ends, both
// sides share one point. So the numbers of vertices and triangles grow with the cut.

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "scenes/simulation/cloth_solver.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

/// Cut along the curve v = height(u), from one end to its present tip.
struct Cut {
    std::function<double(double u)> height;
    double from, tip;  ///< in u, in either order
};

struct CutFabric {
    /// Point on the edge between two points of the uncut fabric, above or below the cut. Where the sides hang together
    /// there is only the point above.
    struct Key {
        std::int32_t low, high;
        bool below;
        friend auto operator<=>(const Key&, const Key&) = default;
    };

    Fabric fabric;                     ///< first the points of the uncut one
    std::map<Key, std::int32_t> made;  ///< indices of the points on the uncut fabric's edges
    std::vector<double> shares;        ///< place of each of them, in order, on its edge, from low (0) to high (1)
};

/// Returns the fabric with cuts. No edge may be crossed by two of the cuts.
CutFabric cut(const Fabric& uncut, std::span<const Cut> cuts);

/// Changes a solver's fabric to the same one with longer cuts. New points get position and velocity from the point or
/// edge that they were cut out of.
void go_on_with(ClothSolver& solver, const CutFabric& before, const CutFabric& after);

}  // namespace crumple::scenes
