#pragma once

// Exact intersection of two closed triangles, for every finite float64 coordinate from subnormal to the largest.
//
// All coordinates of the pair are integers times one power of two, so integers of any width suffice; points of the
// intersection are homogeneous. A triangle, degenerate or not, is a convex set: planes that contain it and half-spaces
// that bound it within them. Every extreme point of A ∩ B lies on an edge of A or of B, because the insides of two
// faces meet in one point only if one of the faces is an edge or a vertex. So the edges of each, clipped by the other,
// have all extreme points among their ends.
//
// This is the reference for all faster decisions: it has no filter, and treats only one case separately: all corners of
// one triangle are strictly on one side of the other's plane. Host only.

#include <array>
#include <vector>

#include "crumple/options.h"
#include "exact/integer.h"
#include "exact/intersection/contact.h"
#include "geometry/triangle.h"

namespace crumple {

/// Returns numerator / denominator · 2^exponent, rounded to the nearest float64, ties to even; +0 for zero, infinite
/// beyond the largest float64. The denominator must be positive.
double round_quotient(const Integer& numerator, const Integer& denominator, int exponent);

/// Point (x, y, z) / w of an intersection, in units of 2^exponent of that intersection; w > 0.
struct RationalPoint {
    Vec3<Integer> xyz;
    Integer w;
};

struct RationalIntersection {
    int exponent = 0;
    std::vector<RationalPoint> points;  ///< extreme points, in the order of crumple::Contacts
    int shared = 0;                     ///< number of distinct vertex ids that both triangles have
    bool collides = false;  ///< true if some point lies outside the hull of the shared vertices, or shared == 3
    bool proper = false;    ///< true if an edge strictly crosses the relative interior of the other triangle
};

/// Computes the intersection. Cost: about 20 us for ordinary coordinates.
RationalIntersection intersect_rationally(const Triangle& a, const Triangle& b);

/// True if the pair collides under `neighbours` and `intersections`, as docs/contract.md defines it.
bool collide(const RationalIntersection& intersection, Neighbours neighbours, IntersectionKind intersections);

/// Returns the extreme points, correctly rounded.
Contact contact(const RationalIntersection& intersection);

/// Returns the point at which the line through p and q crosses the plane of the triangle, correctly rounded. The signed
/// distances of p and q from the plane must differ.
Vec3d round_crossing(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& triangle);

}  // namespace crumple
