#pragma once

// Faces in coordinates in which a direction is vertical, in rational arithmetic. Host only.
//
// A sheared point (x, y, z) has a *place* (x, y), the same for all points of a line along the direction, and a height
// z. A motion along the direction changes heights only. Such coordinates are integers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "exact/overlap/exact_crossing.h"

namespace crumple {

/// Place, or direction of a motion of places.
struct ShearedPlace {
    Rational u, v;

    friend bool operator==(const ShearedPlace&, const ShearedPlace&) = default;
    friend ShearedPlace operator+(const ShearedPlace& p, const ShearedPlace& q) { return {p.u + q.u, p.v + q.v}; }
    friend ShearedPlace operator-(const ShearedPlace& p, const ShearedPlace& q) { return {p.u - q.u, p.v - q.v}; }
    friend ShearedPlace operator*(const Rational& s, const ShearedPlace& p) { return {s * p.u, s * p.v}; }
    friend Rational cross(const ShearedPlace& p, const ShearedPlace& q) { return p.u * q.v - p.v * q.u; }
    friend Rational dot(const ShearedPlace& p, const ShearedPlace& q) { return p.u * q.u + p.v * q.v; }
};

struct BeforeInPlane {
    bool operator()(const ShearedPlace& p, const ShearedPlace& q) const { return p.u != q.u ? p.u < q.u : p.v < q.v; }
};
using PlaceSet = std::set<ShearedPlace, BeforeInPlane>;

/// Returns the bytes of a place, including what its numbers allocate.
std::size_t bytes_of(const ShearedPlace& place);

using ShearedPoint = Vec3<Rational>;

inline ShearedPlace place_of(const ShearedPoint& p) { return {p.x, p.y}; }

/// Conversion to sheared coordinates.
class Shear {
   public:
    /// `direction`: finite, not 0. `axis`: an axis along which the direction's component is not 0. `unit`: all
    /// coordinates of points are multiples of 2^unit.
    Shear(const Vec3d& direction, int axis, int unit);

    ShearedPoint operator()(const Vec3d& p) const;
    /// Returns the multiple of the direction by which a point has to move to become higher by `height`.
    Rational parameter_of(const Rational& height) const { return height / step_; }
    /// Returns a difference of heights in the unit of the coordinates.
    Rational coordinate_of(const Rational& height) const { return height * unit_; }
    /// Returns a place in the unit of the coordinates, relative to which ProjectionAlong (search/withdrawal/) rounds.
    ShearedPlace coordinates_of(const ShearedPlace& place) const;

   private:
    int axis_, exponent_;
    Vec3<Integer> direction_;
    Rational unit_, step_;
};

/// Face in sheared coordinates. It is *upright* if the direction is parallel to it; then it has no height at a place.
class ShearedFace {
   public:
    /// `index`: any number by which the caller recognises the face.
    ShearedFace(const FaceCorners& corners, const Shear& shear, std::int32_t index = -1);

    std::int32_t index() const { return index_; }
    const ShearedPoint& corner(std::size_t k) const { return corner_[k]; }
    ShearedPlace place(std::size_t k) const { return place_of(corner_[k]); }
    /// Returns the vector from corner k to the next one, without its height.
    ShearedPlace edge(std::size_t k) const { return place(k == 2 ? 0 : k + 1) - place(k); }

    bool is_degenerate() const { return normal_ == ShearedPoint{}; }
    bool is_upright() const { return normal_.z == 0; }
    const ShearedPoint& normal() const { return normal_; }
    /// Change of the winding number along the direction through the face, up to one sign for all faces.
    int jump() const { return normal_.z > 0 ? 1 : -1; }

    /// Position of a place relative to a face that is not upright: 1 inside, 0 on the border, −1 outside.
    int position(const ShearedPlace& p) const;
    /// Side of edge k on which a place lies: 1 if it is that of the face, 0 if the place is on the edge's line.
    int side(std::size_t k, const ShearedPlace& p) const { return jump() * sign(cross(edge(k), p - place(k))); }
    /// Returns the height at a place in the plane of a face that is not upright.
    Rational height(const ShearedPlace& p) const;
    /// Returns the bytes of this object, including what its numbers allocate.
    std::size_t bytes() const;
    /// Returns how much the height changes along w.
    Rational slope(const ShearedPlace& w) const { return -(normal_.x * w.u + normal_.y * w.v) / normal_.z; }

   private:
    static int sign(const Rational& x) { return (x > 0) - (x < 0); }

    std::array<ShearedPoint, 3> corner_;
    ShearedPoint normal_;
    std::int32_t index_;
};

/// Adds the places of the extreme points of the intersection of a and b, with b lifted by `lift`. Degenerate faces have
/// none. Cost: some 10 us.
void add_contact_places(const ShearedFace& a, const ShearedFace& b, const Rational& lift, PlaceSet& places);

/// Convex polygon of places. Empty, or with an inside.
class PlacePolygon {
   public:
    /// Intersection of the insides of two faces, which are not upright.
    PlacePolygon(const ShearedFace& a, const ShearedFace& b);

    bool is_empty() const { return corners_.size() < 3; }
    const std::vector<ShearedPlace>& corners() const { return corners_; }
    /// Returns the mean of the corners.
    ShearedPlace middle() const;

    /// Cuts off the part on the right of the line through p along w.
    void cut(const ShearedPlace& p, const ShearedPlace& w);

    /// Returns the least and the greatest height of a above b over the polygon.
    std::pair<Rational, Rational> lifts(const ShearedFace& a, const ShearedFace& b) const;

   private:
    std::vector<ShearedPlace> corners_;
};

}  // namespace crumple
