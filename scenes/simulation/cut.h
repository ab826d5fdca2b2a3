#pragma once

// Cuts a fabric along curves: splits the triangles that a curve crosses, and separates its two sides. An edge that is
// crossed gets two points at the crossing, one for each side of the cut; at the end of the cut both sides share one
// point. So the numbers of vertices and triangles grow with the cut.

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "scenes/simulation/cloth_solver.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

/// Cut along the curve v = height(u), from its first end to its tip, which advances from frame to frame.
struct Cut {
    std::function<double(double u)> height;
    double from, tip;  ///< u of the end and of the tip, in either order
};

struct CutFabric {
    /// Point at which a cut crosses the edge between two points of the uncut fabric, on the side above or below the
    /// cut. Where the sides are not separated, there is only the point above.
    struct Key {
        std::int32_t low, high;
        bool below;
        friend auto operator<=>(const Key&, const Key&) = default;
    };

    Fabric fabric;                     ///< begins with the points of the uncut fabric
    std::map<Key, std::int32_t> made;  ///< indices of the points on the uncut fabric's edges
    std::vector<double> shares;        ///< for each of these, by index: place on its edge, from low (0) to high (1)
};

/// Returns the fabric with cuts. No edge may be crossed by two of the cuts.
CutFabric cut(const Fabric& uncut, std::span<const Cut> cuts);

/// Changes the fabric of a solver to the same fabric with longer cuts. New points get the position and velocity of the
/// point, or of the place on an edge, that they were cut out of.
void switch_fabric(ClothSolver& solver, const CutFabric& before, const CutFabric& after);

}  // namespace crumple::scenes
