#pragma once

// How two faces of closed surfaces cross under a shift, and what that says of winding numbers: signs by filters and
// expansions, numbers in double words with bounds. For coordinates in the range of double words; what the bounds leave
// too open is up to rational_crossing.h. Compiled for host and device.

#include <array>
#include <cstddef>

#include "exact/overlap/enclosed.h"
#include "exact/overlap/face_crossing.h"
#include "geometry/predicates.h"
#include "geometry/triangle.h"

namespace crumple {

using FaceCorners = std::array<Vec3d, 3>;

namespace detail {

CRUMPLE_HD constexpr std::size_t next_corner(std::size_t i) { return i == 2 ? 0 : i + 1; }

/// Sign of component `axis` of (q − p) × (s − r). Four roundings.
CRUMPLE_HD inline int cross_sign(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s, int axis) {
    const int x = first_axis(axis), y = second_axis(axis);
    const double plus = (q[x] - p[x]) * (s[y] - r[y]), minus = (q[y] - p[y]) * (s[x] - r[x]);
    const int sign = certain_sign(plus - minus, 5 * epsilon * (std::abs(plus) + std::abs(minus)) + slack);
    if (sign != undecided) return sign;
    return (exact_difference(q[x], p[x]) * exact_difference(s[y], r[y]) -
            exact_difference(q[y], p[y]) * exact_difference(s[x], r[x]))
        .sign();
}

/// The sign of (q − p) × (s − r) times (e, e², e³), e → 0+.
CRUMPLE_HD inline int first_cross_sign(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
    for (int axis = 0; axis < 3; ++axis)
        if (const int sign = cross_sign(p, q, r, s, axis)) return sign;
    return 0;
}

}  // namespace detail

/// A face with what many pairs read of it.
struct CrossedFace {
    FaceCorners corner;
    FilteredPlane plane;
    /// The sign of the normal times (e, e², e³), e → 0+; 0: the face is degenerate.
    int first_sign;

    CRUMPLE_HD explicit CrossedFace(const FaceCorners& p)
        : corner(p), plane(p), first_sign(detail::first_cross_sign(p[0], p[1], p[0], p[2])) {}
};

/// The signs that cross_faces() asks for.
class QuickSigns {
   public:
    CRUMPLE_HD QuickSigns(const CrossedFace& a, const CrossedFace& b, Shift shift)
        : has_inside_a(a.first_sign != 0), has_inside_b(b.first_sign != 0), a_(a), b_(b), shift_(shift) {}

    bool has_inside_a, has_inside_b;

    CRUMPLE_HD int a_side(std::size_t i) const { return side(b_, a_.corner[i], shift_); }
    CRUMPLE_HD int b_side(std::size_t i) const { return side(a_, b_.corner[i], opposite(shift_)); }
    CRUMPLE_HD int edges(std::size_t i, std::size_t j) const {
        const Vec3d &p = a_.corner[i], &p_end = a_.corner[detail::next_corner(i)];
        const Vec3d &q = b_.corner[j], &q_end = b_.corner[detail::next_corner(j)];
        const bool meet = p == q || p == q_end || p_end == q || p_end == q_end;
        const int sign = meet ? 0 : orient3d(p, p_end, q, q_end);
        return sign != 0 ? sign : sign_of(shift_) * detail::first_cross_sign(q, q_end, p, p_end);
    }

   private:
    CRUMPLE_HD static int side(const CrossedFace& face, const Vec3d& p, Shift shift) {
        int sign = face.plane.side(p);
        const auto& q = face.corner;
        if (sign == undecided)
            sign = p == q[0] || p == q[1] || p == q[2] ? 0 : orient3d_exact(q[0], q[1], q[2], p);
        return sign != 0 ? sign : -sign_of(shift) * face.first_sign;
    }

    const CrossedFace &a_, &b_;
    Shift shift_;
};

/// As RationalWeights.
using FaceWeights = std::array<Enclosed, 3>;

/// The second and the third barycentric coordinate of a point in a face.
struct PointInFace {
    Enclosed u, v;
};

struct QuickCrossing {
    FaceCrossing jumps;
    // If there is a segment:
    PointInFace start_in_a, end_in_a, start_in_b, end_in_b;
    FaceWeights a, b;
    /// False if the numbers are too uncertain to be worth adding.
    bool certain = true;
};

namespace detail {

/// Weights with larger bounds are uncertain; smaller quotients might underflow where they are multiplied.
inline constexpr double largest_weight_error = 0x1p-80, least_quotient = 0x1p-250;

/// Adds a triangle [p0, x, y] of the chain, p0 being the first corner.
CRUMPLE_HD inline void add_cone(const PointInFace& x, const PointInFace& y, FaceWeights& weights) {
    const Enclosed share = x.u * y.v - x.v * y.u, u = x.u + y.u, v = x.v + y.v;
    weights[0] = weights[0] + share * (Enclosed(3) - (u + v));
    weights[1] = weights[1] + share * u;
    weights[2] = weights[2] + share * v;
}

/// Adds `jump` times what is left of edge 01 or 12 behind a point on it, as a cone from the first corner.
CRUMPLE_HD inline void add_edge(std::size_t edge, int jump, const PointInFace& at, FaceWeights& weights) {
    const Enclosed one(jump);
    if (edge == 0)
        for (Enclosed& weight : weights) weight = weight + one;
    if (edge != 1) return;
    const Enclosed share = one * at.u;
    weights[0] = weights[0] + share;
    weights[1] = weights[1] + share * at.u;
    weights[2] = weights[2] + share * (Enclosed(1) + at.v);
}

/// A point on an edge, at t of its way.
CRUMPLE_HD inline PointInFace on_edge(std::size_t edge, const Enclosed& t) {
    if (edge == 0) return {t, Enclosed(0)};
    if (edge == 1) return {Enclosed(1) - t, t};
    return {Enclosed(0), Enclosed(1) - t};
}

/// Where the edge p → p' crosses a face.
struct EdgeCrossing {
    Enclosed t;  ///< on the edge
    PointInFace in_face;
    bool certain;

    CRUMPLE_HD EdgeCrossing(const Vec3d& p, const Vec3d& p_end, const FaceCorners& face, const EnclosedVec3& normal) {
        const Enclosed from = dot(normal, difference(p, face[0])), to = dot(normal, difference(p_end, face[0]));
        const Enclosed all = from - to;
        const EnclosedVec3 along = difference(p_end, p), q0 = difference(face[0], p);
        const Enclosed u = -(dot(along, cross(difference(face[2], p), q0)) / all);
        const Enclosed v = -(dot(along, cross(q0, difference(face[1], p))) / all);
        t = from / all;
        in_face = {u, v};
        const auto sound = [](const Enclosed& x) { return x.value.high == 0 || x.magnitude() >= least_quotient; };
        certain = sound(t) && sound(u) && sound(v);
    }
};

CRUMPLE_HD inline EnclosedVec3 normal_of(const FaceCorners& p) {
    return cross(difference(p[1], p[0]), difference(p[2], p[0]));
}

}  // namespace detail

/// b is shifted. All coordinates in the range of double words.
CRUMPLE_HD inline QuickCrossing cross_quickly(const CrossedFace& a, const CrossedFace& b, Shift shift) {
    QuickCrossing crossing;
    const QuickSigns signs(a, b, shift);
    crossing.jumps = cross_faces(signs);
    if (!crossing.jumps.segment) return crossing;
    const EnclosedVec3 normal_a = detail::normal_of(a.corner), normal_b = detail::normal_of(b.corner);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = detail::next_corner(i);
        if (const int jump = crossing.jumps.a[i]) {
            const detail::EdgeCrossing at(a.corner[i], a.corner[next], b.corner, normal_b);
            const PointInFace in_a = detail::on_edge(i, at.t);
            (jump > 0 ? crossing.end_in_a : crossing.start_in_a) = in_a;
            (jump > 0 ? crossing.end_in_b : crossing.start_in_b) = at.in_face;
            detail::add_edge(i, jump, in_a, crossing.a);
            crossing.certain &= at.certain;
        }
        if (const int jump = crossing.jumps.b[i]) {
            const detail::EdgeCrossing at(b.corner[i], b.corner[next], a.corner, normal_a);
            const PointInFace in_b = detail::on_edge(i, at.t);
            (jump > 0 ? crossing.start_in_a : crossing.end_in_a) = at.in_face;
            (jump > 0 ? crossing.start_in_b : crossing.end_in_b) = in_b;
            detail::add_edge(i, jump, in_b, crossing.b);
            crossing.certain &= at.certain;
        }
    }
    detail::add_cone(crossing.start_in_a, crossing.end_in_a, crossing.a);
    detail::add_cone(crossing.end_in_b, crossing.start_in_b, crossing.b);
    for (std::size_t k = 0; k < 3; ++k)
        crossing.certain &= crossing.a[k].error <= detail::largest_weight_error &&
                            crossing.b[k].error <= detail::largest_weight_error;
    return crossing;
}

}  // namespace crumple
