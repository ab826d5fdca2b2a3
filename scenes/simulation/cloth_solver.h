#pragma once

// Cloth solver by extended position based dynamics: XPBD with small steps (Macklin, Mueller, Chentanez, XPBD, 2016;
// Macklin et al., Small Steps in Physics Simulation, 2019).
//
// A time step predicts positions, moves them onto constraints one after another (Gauss-Seidel), and derives velocities
// from the displacements. A step goes through the constraints forward and backward: a forward pass alone gains energy
// on a regular grid, because its iteration has complex eigenvalues, while both passes together are symmetric, with
// eigenvalues in [0, 1]. Constraints are distances. Those along the triangles' edges are stiff along warp and weft, and
// soft between these directions, as in woven cloth. Those across inner edges, between the two opposite corners, resist
// bending. Contacts of the sheet with itself and with bodies follow, with Coulomb friction. All points have mass 1.
//
// advance() finds contacts with bodies by signed distances, and contacts of the sheet with itself by whiskers
// (self_contact.h): this is fast, but cloth may pass through itself. advance_freely() finds all contacts by proximity
// queries; bodies are meshes, and motion queries shorten every step until it is free of impacts (near_contact.h). So
// nothing passes through anything.
//
// The order of all operations is fixed, and arithmetic is that of IEEE, so the same input gives the same bits on every
// machine.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/vec.h"
#include "scenes/simulation/collider.h"
#include "scenes/simulation/fabric.h"
#include "scenes/simulation/near_contact.h"
#include "scenes/simulation/self_contact.h"

namespace crumple::scenes {

struct ClothProperties {
    double gravity = 9.81;        ///< units / s², downwards
    double drag = 0.5;            ///< relative deceleration by the air, 1 / s
    double shear_speed = 0;       ///< speed of shear waves, units / s; higher: stiffer. (Warp and weft do not stretch.)
    double bend_speed = 0;        ///< speed of waves that the springs across edges carry, units / s; higher: stiffer
    double thickness = 0;         ///< distance that the sheet keeps from itself and from obstacles, units
    double clearance = 0;         ///< distance that the sheet keeps from bodies in advance(), units
    double separation_speed = 0;  ///< highest speed of points that leave a contact, units / s
    double self_friction = 0.2;   ///< Coulomb's coefficient between two parts of the cloth
};

/// Result of one step of ClothSolver::advance_freely().
struct StepLength {
    std::size_t contacts;   ///< pairs of features that were near at the start of the step
    double toi;             ///< fraction of the step, as NearContactFinder::FreePath::toi
    std::size_t held_back;  ///< points whose movement was shortened
    double share;           ///< fraction of its movement that each other point made; < 1 only if cloth is caught
};

class ClothSolver {
   public:
    ClothSolver(const Fabric& fabric, const ClothProperties& properties);

    /// Replaces the fabric: resizes `points`, `velocities` and `held`, and removes all obstacles.
    void set_fabric(const Fabric& fabric);

    /// Makes `steps` equal steps from `time` on, which take `seconds` in total. Calls move(t) before the step that ends
    /// at time t, to place the bodies. Finds contacts of the sheet with itself before every `contact_interval`-th step.
    /// Points that approach each other by more than the thickness before contacts are found again may pass through the
    /// sheet.
    template <class Move>
    void advance(double time, double seconds, int steps, int contact_interval, std::span<const Collider* const> bodies,
                 Move move) {
        const double dt = seconds / steps;
        for (int i = 0; i < steps; ++i) {
            if (i % contact_interval == 0) find_contacts();
            move(time + seconds * (i + 1) / steps);
            step(dt, bodies, (i % contact_interval + 1) * dt);
        }
    }

    /// Adds a body for advance_freely(), as a mesh. Its points are appended to `points`, and are held: see `held`.
    void add_obstacle(std::span<const Vec3d> at, std::span<const Fabric::Corners> triangles, double friction);

    /// Makes `steps` equal steps of `substeps` substeps each, which take `seconds` in total. Nothing passes through
    /// anything; this is decided exactly for the coordinates in `points`. Throws Error if anything touches at the
    /// start. Nothing should intersect at the start, because it would go on intersecting. move(t, at) sets `at`, the
    /// obstacles' points in their order, to their positions at time t; the points move there on straight lines. Calls
    /// `watch` with each StepLength. If cloth is caught between moving obstacles, StepLength::share is less than 1:
    /// obstacles then lag behind, and catch up as soon as nothing blocks them. If no point can give way, because all
    /// are held, the share decreases from step to step to 0.
    template <class Move, class Watch>
    void advance_freely(double time, double seconds, int steps, int substeps, Move move, Watch watch) {
        for (int i = 0; i < steps; ++i) {
            move(time + seconds * (i + 1) / steps, std::span<Vec3d>(goals_));
            watch(step_freely(seconds / steps, substeps));
        }
    }

    std::vector<Vec3d> points, velocities;  ///< of the cloth, then of the obstacles
    std::vector<std::uint8_t> held;         ///< by point: 1 if it moves with a given velocity, whatever acts on it

   private:
    struct Spring {
        std::int32_t a, b;
        double rest, stiffness;  ///< length in units; stiffness in 1 / s², infinite: constant length
    };

    void find_contacts() { contacts_ = finder_.find(points, triangles_, properties_.thickness); }
    void step(double dt, std::span<const Collider* const> bodies, double age);
    StepLength step_freely(double dt, int substeps);
    /// Predicts positions, then moves points along the springs to restore their lengths.
    void pull(double dt);
    void predict(double dt);
    void derive_velocities(double dt);
    void keep_distance(const Spring& spring, double dt);
    /// Moves the two features of a contact apart. `age`: seconds from the search that found the contact to the end of
    /// the step.
    void part(const SelfContact& contact, double age);
    void part(const Stencils& contacts, std::size_t row, double age);
    void push_out(std::span<const Collider* const> bodies, double dt);

    ClothProperties properties_;
    std::vector<Fabric::Corners> triangles_;
    std::vector<Spring> springs_;
    std::vector<Vec3d> before_;  ///< positions at the start of the step
    SelfContactFinder finder_;
    std::span<const SelfContact> contacts_;

    std::vector<Fabric::Corners> obstacles_;
    std::vector<Vec3d> goals_;      ///< target positions of the obstacles' points
    std::vector<double> friction_;  ///< Coulomb's coefficients of the obstacles' points
    std::vector<Vec3d> start_, unshortened_;
    std::optional<NearContactFinder> near_;
};

}  // namespace crumple::scenes
