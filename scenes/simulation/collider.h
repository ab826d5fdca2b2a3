#pragma once

// Bodies that cloth falls on, given by signed distances. Surfaces are round where the meshes of these bodies have
// facets, so that cloth slides.

#include <array>
#include <limits>
#include <vector>

#include "geometry/vec.h"

namespace crumple::scenes {

/// Nearest point of a surface to a given point.
struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< negative inside the body
    Vec3d normal{};                                             ///< outward, of length 1
    Vec3d velocity{};                                           ///< velocity of the surface at the nearest point
};

class Collider {
   public:
    virtual ~Collider() = default;
    virtual Nearest nearest(Vec3d point) const = 0;

    double friction = 0.3;  ///< Coulomb's coefficient
};

/// Half space below a height.
class Floor : public Collider {
   public:
    explicit Floor(double height) : height_(height) {}
    Nearest nearest(Vec3d point) const override { return {point.z - height_, {0, 0, 1}, {}}; }

   private:
    double height_;
};

/// Ball that moves, spins and grows.
class MovingBall : public Collider {
   public:
    Vec3d centre{}, velocity{}, spin{};  ///< spin: axis of length 1, times radians per second
    double radius = 1, growth = 0;       ///< units; units per second

    Nearest nearest(Vec3d point) const override;
};

/// Inner surface of a funnel: a surface of revolution about z, given by its profile from the rim down to the spout. The
/// side of the axis is free. Points behind the surface are in the wall, up to a depth of `wall`; beyond that they are
/// free, too.
class Funnel : public Collider {
   public:
    using Profile = std::vector<std::array<double, 2>>;  ///< (radius, height)
    Funnel(Profile profile, double wall) : profile_(std::move(profile)), wall_(wall) {}

    Nearest nearest(Vec3d point) const override;

   private:
    Profile profile_;
    double wall_;
};

}  // namespace crumple::scenes
