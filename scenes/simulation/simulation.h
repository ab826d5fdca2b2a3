#pragma once

// A scene that is simulated: where it starts, what happens from frame to frame, and how a frame becomes a mesh.
//
// What changes is the cloth's points and their velocities alone; everything else follows from the parameters and the
// frame. So a frame can be shown from its points, and a simulation can go on from any frame's state.

#include <span>

#include "crumple/io.h"
#include "scenes/simulation/cloth_solver.h"

namespace crumple::scenes {

class Simulation {
   public:
    virtual ~Simulation() = default;

    /// The cloth of a frame, flat.
    virtual Fabric fabric(int frame) const = 0;

    /// The solver as it stands at frame 0.
    virtual ClothSolver begin() const = 0;

    /// Takes the solver from frame - 1 to `frame`, at least 1.
    virtual void advance(ClothSolver& solver, int frame) const = 0;

    /// The frame as a mesh, from the cloth's points, 3 coordinates each.
    virtual io::TriangleMesh mesh(int frame, std::span<const float> points) const = 0;
};

}  // namespace crumple::scenes
