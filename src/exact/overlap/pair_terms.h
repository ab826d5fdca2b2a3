#pragma once

// Terms of a pair of faces in the integrals over an overlap (docs/overlap.md), for any type of number that is exact or
// has a bound. Compiled for host and device.

#include "exact/overlap/crossing.h"
#include "geometry/vec.h"

namespace crumple {

/// Corners of a face from the origin O of the sums, and its normal (p1 − p0) × (p2 − p0).
template <class Number>
struct PlacedFace {
    std::array<Vec3<Number>, 3> corner;
    Vec3<Number> normal;

    /// Six times the volume of the cone from O.
    CRUMPLE_HD Number cone() const { return dot(normal, corner[0]); }
    CRUMPLE_HD Vec3<Number> at(const PointInFace<Number>& p) const {
        return corner[0] + p.u * (corner[1] - corner[0]) + p.v * (corner[2] - corner[0]);
    }
};

/// Sums over the faces of both surfaces, with their weights, whose sum is f:
template <class Number>
struct VolumeTerms {
    Number volume{};        ///< cone f: 18 times the volume
    Vec3<Number> moment{};  ///< cone (w0 p0 + w1 p1 + w2 p2): 24 times the first moment about O

    CRUMPLE_HD void add(const PlacedFace<Number>& face, const FaceWeights<Number>& w, bool with_moment = true) {
        const auto& p = face.corner;
        const Number cone = face.cone();
        volume = volume + cone * (w[0] + w[1] + w[2]);
        if (with_moment) moment = moment + cone * (w[0] * p[0] + w[1] * p[1] + w[2] * p[2]);
    }
    /// The same where the winding number is constant.
    CRUMPLE_HD void add(const PlacedFace<Number>& face, int winding, bool with_moment = true) {
        const auto& p = face.corner;
        const Number cone = Number(winding) * face.cone();
        volume = volume + Number(3) * cone;
        if (with_moment) moment = moment + cone * (p[0] + p[1] + p[2]);
    }
};

/// Sums over the segments from s to e, as seen on the first surface:
template <class Number>
struct CurveTerms {
    Vec3<Number> area{};    ///< s × e: twice the area vector
    Vec3<Number> torque{};  ///< (e − s) (s² + s e + e²): −6 times the torque about O

    CRUMPLE_HD void add(const Vec3<Number>& s, const Vec3<Number>& e) {
        area = area + cross(s, e);
        torque = torque + (dot(s, s + e) + dot(e, e)) * (e - s);
    }
};

}  // namespace crumple
