#pragma once

// Crosses two faces of closed surfaces under a shift: signs by filters and expansions, numbers in double words with
// bounds. For coordinates in the range of double words; where bounds are too wide, rational_crossing.h decides.
// Compiled for host and device.

#include <array>
#include <cstddef>

#include "exact/overlap/crossing.h"
#include "exact/overlap/enclosed.h"
#include "geometry/predicates.h"
#include "geometry/triangle.h"

namespace crumple {

using FaceCorners = std::array<Vec3d, 3>;

namespace detail {

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

    CRUMPLE_HD Vec3<Enclosed> normal() const {
        return cross(enclosed_difference(corner[1], corner[0]), enclosed_difference(corner[2], corner[0]));
    }
};

/// The signs that cross_faces() asks for.
class QuickSigns {
   public:
    CRUMPLE_HD QuickSigns(const CrossedFace& a, const CrossedFace& b, Shift shift)
        : has_inside_a(a.first_sign != 0), has_inside_b(b.first_sign != 0), a_(a), b_(b), shift_(shift) {}

    bool has_inside_a, has_inside_b;
    /// True if a sign is that of the shift, so that it is the opposite for the opposite shift.
    bool tied = false;

    CRUMPLE_HD int a_side(std::size_t i) { return side(b_, a_.corner[i], shift_); }
    CRUMPLE_HD int b_side(std::size_t i) { return side(a_, b_.corner[i], opposite(shift_)); }
    CRUMPLE_HD int edges(std::size_t i, std::size_t j) {
        const Vec3d &p = a_.corner[i], &p_end = a_.corner[next_corner(i)];
        const Vec3d &q = b_.corner[j], &q_end = b_.corner[next_corner(j)];
        const bool meet = p == q || p == q_end || p_end == q || p_end == q_end;
        const int sign = meet ? 0 : orient3d(p, p_end, q, q_end);
        if (sign != 0) return sign;
        tied = true;
        return sign_of(shift_) * detail::first_cross_sign(q, q_end, p, p_end);
    }

   private:
    CRUMPLE_HD int side(const CrossedFace& face, const Vec3d& p, Shift shift) {
        int sign = face.plane.side(p);
        const auto& q = face.corner;
        if (sign == undecided) sign = p == q[0] || p == q[1] || p == q[2] ? 0 : orient3d_exact(q[0], q[1], q[2], p);
        if (sign != 0) return sign;
        tied = true;
        return -sign_of(shift) * face.first_sign;
    }

    const CrossedFace &a_, &b_;
    Shift shift_;
};

struct QuickCrossing : Crossing<Enclosed> {
    bool tied = false;  ///< with the opposite shift the faces may cross differently
    /// False if the numbers are too uncertain to be worth adding.
    bool certain = true;
};

namespace detail {

/// Weights with larger bounds are uncertain; smaller quotients might underflow where they are multiplied.
inline constexpr double largest_weight_error = 0x1p-80, least_quotient = 0x1p-250;

/// Returns the point at which the edge p → p' crosses a face.
CRUMPLE_HD inline EdgeCrossing<Enclosed> cross_edge(const Vec3d& p, const Vec3d& p_end, const FaceCorners& face,
                                                    const Vec3<Enclosed>& normal) {
    const Enclosed from = dot(normal, enclosed_difference(p, face[0])),
                   to = dot(normal, enclosed_difference(p_end, face[0]));
    const Enclosed all = from - to;
    const Vec3<Enclosed> along = enclosed_difference(p_end, p), q0 = enclosed_difference(face[0], p);
    return {from / all,
            {-(dot(along, cross(enclosed_difference(face[2], p), q0)) / all),
             -(dot(along, cross(q0, enclosed_difference(face[1], p))) / all)}};
}

CRUMPLE_HD inline bool may_be_multiplied(const EdgeCrossing<Enclosed>& at) {
    const auto sound = [](const Enclosed& x) { return x.value.high == 0 || x.magnitude() >= least_quotient; };
    return sound(at.t) && sound(at.in_face.u) && sound(at.in_face.v);
}

}  // namespace detail

/// b is shifted. All coordinates in the range of double words.
CRUMPLE_HD inline QuickCrossing cross_quickly(const CrossedFace& a, const CrossedFace& b, Shift shift) {
    QuickCrossing crossing;
    QuickSigns signs(a, b, shift);
    crossing.jumps = cross_faces(signs);
    crossing.tied = signs.tied;
    if (!crossing.jumps.segment) return crossing;
    const Vec3<Enclosed> normal_a = a.normal(), normal_b = b.normal();
    const auto cross_edge = [&](const CrossedFace& of, std::size_t i, const CrossedFace& face, const auto& normal) {
        const auto at = detail::cross_edge(of.corner[i], of.corner[next_corner(i)], face.corner, normal);
        crossing.certain &= detail::may_be_multiplied(at);
        return at;
    };
    add_segment<Enclosed>([&](std::size_t i) { return cross_edge(a, i, b, normal_b); },
                          [&](std::size_t i) { return cross_edge(b, i, a, normal_a); }, crossing);
    for (std::size_t k = 0; k < 3; ++k)
        crossing.certain &=
            crossing.a[k].error <= detail::largest_weight_error && crossing.b[k].error <= detail::largest_weight_error;
    return crossing;
}

}  // namespace crumple
