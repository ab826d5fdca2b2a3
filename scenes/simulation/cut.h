#pragma once

// Cutting a fabric along a curve: triangles that the curve crosses are split, and its two sides no longer hang
// together.
//
// An edge that is crossed gets a point there for either side of the cut, at the same place; where the cut ends, both
// sides share one. So vertices and triangles become more as the cut grows.

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "scenes/simulation/cloth_solver.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

/// The curve v = height(u) from one end to a tip, cut out as far as it has come.
struct Cut {
    std::function<double(double u)> height;
    double from, tip;  ///< in u, in either order
};

struct CutFabric {
    /// A point on the edge between two points of the uncut fabric, above or below the cut. Where the sides hang
    /// together there is only the one above.
    struct Key {
        std::int32_t low, high;
        bool below;
        friend auto operator<=>(const Key&, const Key&) = default;
    };

    Fabric fabric;                     ///< first the points of the uncut one
    std::map<Key, std::int32_t> made;  ///< indices of the points on its edges
    std::vector<double> shares;        ///< for each of them, in order: where on its edge, from low (0) to high (1)
};

/// No edge may be crossed by two of the cuts.
CutFabric cut(const Fabric& uncut, std::span<const Cut> cuts);

/// Brings a solver from a fabric to the same one with longer cuts: new points move with what they were cut out of.
void go_on_with(ClothSolver& solver, const CutFabric& before, const CutFabric& after);

}  // namespace crumple::scenes
