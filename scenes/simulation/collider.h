#pragma once

// Bodies that cloth falls on, by signed distance: exact where their meshes have facets, so that cloth slides.

#include <array>
#include <limits>
#include <vector>

#include "geometry/vec.h"

namespace crumple::scenes {

/// The nearest point of a surface.
struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< negative inside
    Vec3d normal{};                                             ///< outward, of length 1
    Vec3d velocity{};                                           ///< of the surface there
};

class Collider {
   public:
    virtual ~Collider() = default;
    virtual Nearest nearest(Vec3d point) const = 0;

    double friction = 0.3;  ///< Coulomb's coefficient
};

/// The half space below a height.
class Floor : public Collider {
   public:
    explicit Floor(double height) : height_(height) {}
    Nearest nearest(Vec3d point) const override { return {point.z - height_, {0, 0, 1}, {}}; }

   private:
    double height_;
};

/// A ball that moves, spins and grows.
class Ball : public Collider {
   public:
    Vec3d centre{}, velocity{}, spin{};  ///< spin: axis times radians a second
    double radius = 1, growth = 0;       ///< units, and units a second

    Nearest nearest(Vec3d point) const override;
};

/// The inside of a surface of revolution about z, drawn by a profile from the rim down to the spout. Points deeper
/// behind it than `wall` are outside and free.
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
