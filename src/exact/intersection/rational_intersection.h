#pragma once

// The exact intersection of two closed triangles, for every finite float64 coordinate from subnormal to the largest.
//
// All coordinates of the pair are integers times one power of two, so plain integers of any width do; points of the
// intersection are homogeneous. A triangle is a convex set: planes that hold it and half-spaces that bound it within
// them; a degenerate triangle is one just the same. Every extreme point of A ∩ B lies on an edge of A or of B, because
// the insides of two faces meet in one point only if one of the faces is an edge or a vertex. So the edges of each,
// clipped by the other, have all extreme points among their ends.
//
// This is the yardstick for everything faster: it has no filter, and of cases for how two triangles lie only the one in
// which all corners of one are beyond the other's plane. Host only.

#include <array>
#include <vector>

#include "crumple/options.h"
#include "exact/integer.h"
#include "exact/intersection/contact.h"
#include "geometry/triangle.h"

namespace crumple {

/// numerator / denominator · 2^exponent, rounded to the nearest float64, ties to even; +0 for zero. The denominator is
/// positive. A result beyond the largest float64 is not expected: points of triangles never are.
double round_quotient(const Integer& numerator, const Integer& denominator, int exponent);

/// The point (x, y, z) / w in units of 2^exponent of the intersection that it belongs to; w > 0.
struct RationalPoint {
    Vec3<Integer> xyz;
    Integer w;
};

struct RationalIntersection {
    int exponent = 0;
    std::vector<RationalPoint> points;  ///< extreme points, in the order that crumple::Contacts demands
    int shared = 0;                     ///< distinct vertex ids that both triangles name
    bool collides = false;              ///< some point lies outside the hull of the shared vertices, or shared == 3
    bool proper = false;                ///< an edge strictly crosses the relative interior of the other triangle
};

/// Cost: some 20 us for ordinary coordinates.
RationalIntersection intersect_rationally(const Triangle& a, const Triangle& b);

/// The contract's answer for a pair under the policies.
bool collide(const RationalIntersection& intersection, Neighbours neighbours, IntersectionKind intersections);

/// The extreme points, correctly rounded.
Contact contact(const RationalIntersection& intersection);

/// Where the line through p and q crosses the plane of the triangle, correctly rounded; p and q must not be at equal
/// distance from it.
Vec3d round_crossing(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& triangle);

}  // namespace crumple
