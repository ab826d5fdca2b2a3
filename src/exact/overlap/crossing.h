#pragma once

// Computes what the segment in which two faces cross contributes to integrals of winding numbers over these faces, for
// any type of number that is exact or has an error bound. Compiled for host and device.
//
// On a face, the winding number of the other surface is a constant, its value at the face's first corner, plus a sum of
// multiples of indicator functions of cones: triangles that the first corner spans with a segment (docs/overlap.md).
// The factor is a jump (EdgeJumps). Each point at which edge 01 or 12 crosses the other surface adds the cones over the
// rest of the path along edges 01 and 12, from that point to corner 2. Each segment adds the cone over itself. So each
// pair of faces contributes independently, in any order.

#include <array>
#include <cstddef>

#include "exact/overlap/face_crossing.h"

namespace crumple {

CRUMPLE_HD constexpr std::size_t next_corner(std::size_t i) { return i == 2 ? 0 : i + 1; }

/// Second and third barycentric coordinates of a point in a face.
template <class Number>
struct PointInFace {
    Number u{}, v{};
};

/// Weights of a face's corners: 3 ∫ w φ_k dA / |f|, where w is the winding number of the other surface, |f| the area of
/// the face, and φ_k the hat function of corner k. If w is constant on the face, each weight is w.
template <class Number>
using FaceWeights = std::array<Number, 3>;

/// Point at which an edge crosses a face.
template <class Number>
struct EdgeCrossing {
    Number t;  ///< parameter along the edge, 0 at its start
    PointInFace<Number> in_face;
};

template <class Number>
struct Crossing {
    FaceCrossing jumps;
    // Ends of the segment, if there is one. On a, the inside of b's surface is to the left of the segment. On b, the
    // segment is traversed from end to start.
    PointInFace<Number> start_in_a, end_in_a, start_in_b, end_in_b;
    FaceWeights<Number> a{}, b{};  ///< contributions to the weights of each face
};

namespace detail {

template <class Number>
CRUMPLE_HD PointInFace<Number> on_edge(std::size_t edge, const Number& t) {
    if (edge == 0) return {t, Number(0)};
    if (edge == 1) return {Number(1) - t, t};
    return {Number(0), Number(1) - t};
}

/// Adds the contribution of the triangle [p0, x, y], where p0 is the face's first corner, to the weights.
template <class Number>
CRUMPLE_HD void add_cone(const PointInFace<Number>& x, const PointInFace<Number>& y, FaceWeights<Number>& weights) {
    const Number share = x.u * y.v - x.v * y.u, u = x.u + y.u, v = x.v + y.v;
    weights[0] = weights[0] + share * (Number(3) - (u + v));
    weights[1] = weights[1] + share * u;
    weights[2] = weights[2] + share * v;
}

/// Adds the contribution of an edge's crossing at a point: `jump` times the cones over the path along edges 01 and 12
/// from that point on. For edge 20, which is not on the path, adds nothing.
template <class Number>
CRUMPLE_HD void add_edge(std::size_t edge, int jump, const PointInFace<Number>& at, FaceWeights<Number>& weights) {
    if (edge == 0)
        for (Number& weight : weights) weight = weight + Number(jump);
    if (edge != 1) return;
    const Number share = Number(jump) * at.u;
    weights[0] = weights[0] + share;
    weights[1] = weights[1] + share * at.u;
    weights[2] = weights[2] + share * (Number(1) + at.v);
}

}  // namespace detail

/// Computes the ends of the segment and the weights from crossing.jumps. edge_of_a(i) returns the point at which edge i
/// of a crosses b, and edge_of_b(i) that at which edge i of b crosses a.
template <class Number, class EdgeOfA, class EdgeOfB>
CRUMPLE_HD void add_segment(EdgeOfA edge_of_a, EdgeOfB edge_of_b, Crossing<Number>& crossing) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (const int jump = crossing.jumps.a[i]) {
            const EdgeCrossing<Number> at = edge_of_a(i);
            const PointInFace<Number> in_a = detail::on_edge(i, at.t);
            (jump > 0 ? crossing.end_in_a : crossing.start_in_a) = in_a;
            (jump > 0 ? crossing.end_in_b : crossing.start_in_b) = at.in_face;
            detail::add_edge(i, jump, in_a, crossing.a);
        }
        if (const int jump = crossing.jumps.b[i]) {
            const EdgeCrossing<Number> at = edge_of_b(i);
            const PointInFace<Number> in_b = detail::on_edge(i, at.t);
            (jump > 0 ? crossing.start_in_a : crossing.end_in_a) = at.in_face;
            (jump > 0 ? crossing.start_in_b : crossing.end_in_b) = in_b;
            detail::add_edge(i, jump, in_b, crossing.b);
        }
    }
    detail::add_cone(crossing.start_in_a, crossing.end_in_a, crossing.a);
    detail::add_cone(crossing.end_in_b, crossing.start_in_b, crossing.b);
}

}  // namespace crumple
