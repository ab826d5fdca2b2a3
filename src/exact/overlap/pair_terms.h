#pragma once

// Terms of the integrals over an overlap (docs/overlap.md), for any type of number that is exact or has an error bound.
// All points are relative to the origin O of the sums. Compiled for host and device.
//
// The volume is a sum of volumes of cones from O over oriented triangles. Each face counts as often as the winding
// number of the other surface at the face's first corner. In addition, a segment s → e in which faces a and b, with the
// first corners p and q, cross adds the following triangles. The jump is the change of the winding number along the
// edge on which the segment ends (face_crossing.h).
//
//   [p, s, e] on a, [q, e, s] on b
//   [first corner, x, last corner] times the jump, if the segment ends at x on edge 12 of a face
//   the whole face times the jump, if the segment ends on edge 01

#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// Face, and the number of times that it counts in the sums, which may be negative.
struct CountedFace {
    std::int32_t face, times;
};

template <class Number>
struct VolumeTerms {
    Number volume{};        ///< determinants: 6 times the volume
    Vec3<Number> moment{};  ///< determinants times the sum of corners: 24 times the first moment about O

    CRUMPLE_HD void add(const Number& determinant, const Vec3<Number>& sum_of_corners) {
        volume = volume + determinant;
        moment = moment + determinant * sum_of_corners;
    }
    CRUMPLE_HD void add(const VolumeTerms& other) {
        volume = volume + other.volume;
        moment = moment + other.moment;
    }
};

/// Sums over the segments s → e, with the orientation that they have on the first surface.
template <class Number>
struct CurveTerms {
    Vec3<Number> area{};    ///< s × e: twice the area vector
    Vec3<Number> torque{};  ///< (e − s) (s² + s e + e²): −6 times the torque about O

    CRUMPLE_HD void add(const Vec3<Number>& s, const Vec3<Number>& e) {
        area = area + cross(s, e);
        torque = torque + (dot(s, s + e) + dot(e, e)) * (e - s);
    }
    CRUMPLE_HD void add(const CurveTerms& other) {
        area = area + other.area;
        torque = torque + other.torque;
    }
};

}  // namespace crumple
