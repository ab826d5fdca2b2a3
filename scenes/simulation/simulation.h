#pragma once

// Interface of a simulated scene: its start, its advance from frame to frame, and the mesh of a frame.
//
// Only the cloth's points and their velocities are simulated; everything else is a function of the parameters and the
// frame. So the mesh of a frame can be made from its points, and a simulation can resume from any frame's state.

#include <span>

#include "crumple/io.h"
#include "scenes/simulation/cloth_solver.h"

namespace crumple::scenes {

class Simulation {
   public:
    virtual ~Simulation() = default;

    /// Returns the cloth of a frame before deformation: its triangles, and its points in the plane.
    virtual Fabric fabric(int frame) const = 0;

    /// Returns the solver at frame 0.
    virtual ClothSolver begin() const = 0;

    /// Advances the solver from frame - 1 to `frame`, which is at least 1.
    virtual void advance(ClothSolver& solver, int frame) const = 0;

    /// Returns the frame as a mesh, from the cloth's points, 3 coordinates each.
    virtual io::TriangleMesh mesh(int frame, std::span<const float> points) const = 0;
};

}  // namespace crumple::scenes
