#pragma once

// Crosses two faces of closed surfaces under a shift: signs by filters and expansions, numbers in double words with
// bounds. For coordinates in the range of double words; where bounds are too wide, rational_crossing.h decides.
// Compiled for host and device.

#include <array>
#include <cstddef>

#include "exact/overlap/crossing.h"
#include "exact/overlap/enclosed.h"
#include "exact/overlap/segment.h"
#include "geometry/predicates.h"
#include "geometry/triangle.h"

namespace crumple {

namespace detail {

/// Sign of component `axis` of (q − p) × (s − r). Four roundings.
CRUMPLE_HD inline int cross_sign(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s, int axis) {
    const int x = first_axis(axis), y = second_axis(axis);
    const double plus = (q[x] - p[x]) * (s[y] - r[y]), minus = (q[y] - p[y]) * (s[x] - r[x]);
    const int sign = certain_sign(plus - minus, 5 * epsilon * (std::abs(plus) + std::abs(minus)) + slack);
    if (sign != undecided) return sign;
    return (crumple::exact_difference(q[x], p[x]) * crumple::exact_difference(s[y], r[y]) -
            crumple::exact_difference(q[y], p[y]) * crumple::exact_difference(s[x], r[x]))
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
        const int sign = sign_of_edges(i, j);
        if (sign != 0) return sign;
        tied = true;
        const auto &p = a_.corner, &q = b_.corner;
        return sign_of(shift_) * detail::first_cross_sign(q[j], q[next_corner(j)], p[i], p[next_corner(i)]);
    }

    /// The corner at which an edge crosses the other face exactly, or −1.
    CRUMPLE_HD int vertex(std::size_t of_b, std::size_t edge) const {
        const CrossedFace &face = of_b ? a_ : b_, &of = of_b ? b_ : a_;
        if (!tied) return -1;
        if (sign_of_side(face, of.corner[edge]) == 0) return static_cast<int>(edge);
        return sign_of_side(face, of.corner[next_corner(edge)]) == 0 ? static_cast<int>(next_corner(edge)) : -1;
    }

    /// The signs of the placement as given, which may be 0.
    CRUMPLE_HD static int sign_of_side(const CrossedFace& face, const Vec3d& p) {
        const int sign = face.plane.side(p);
        const auto& q = face.corner;
        if (sign != undecided) return sign;
        return p == q[0] || p == q[1] || p == q[2] ? 0 : orient3d_exact(q[0], q[1], q[2], p);
    }
    CRUMPLE_HD int sign_of_edges(std::size_t i, std::size_t j) const {
        const Vec3d &p = a_.corner[i], &p_end = a_.corner[next_corner(i)];
        const Vec3d &q = b_.corner[j], &q_end = b_.corner[next_corner(j)];
        return p == q || p == q_end || p_end == q || p_end == q_end ? 0 : orient3d(p, p_end, q, q_end);
    }

   private:
    CRUMPLE_HD int side(const CrossedFace& face, const Vec3d& p, Shift shift) {
        const int sign = sign_of_side(face, p);
        if (sign != 0) return sign;
        tied = true;
        return -sign_of(shift) * face.first_sign;
    }

    const CrossedFace &a_, &b_;
    Shift shift_;
};

/// Decides how two faces cross. b is shifted. All coordinates in the range of double words.
CRUMPLE_HD inline DecidedCrossing decide_crossing(const CrossedFace& a, const CrossedFace& b, Shift shift) {
    QuickSigns signs(a, b, shift);
    DecidedCrossing crossing;
    crossing.jumps = cross_faces(signs);
    crossing.tied = signs.tied;
    if (crossing.jumps.segment)
        crossing.segment = segment_of(crossing.jumps, [&](auto side, auto edge) { return signs.vertex(side, edge); });
    return crossing;
}

struct QuickCrossing : Crossing<Enclosed> {
    bool tied = false;  ///< with the opposite shift the faces may cross differently
    /// False if the numbers are too uncertain to be worth adding.
    bool certain = true;
};

namespace detail {

/// Weights with larger bounds are uncertain; smaller quotients might underflow where they are multiplied.
inline constexpr double largest_weight_error = 0x1p-80, least_quotient = 0x1p-250;

/// What is known of an edge p → p' that crosses a face: which numbers are exactly 0 in the placement as given. So a
/// crossing at a vertex or on an edge has whole numbers without error, and sums of such numbers can be 0 for certain.
struct KnownZeros {
    bool from = false, to = false;                  ///< distances of p and p' from the plane
    std::array<bool, 3> edge{false, false, false};  ///< the edge and edge k of the face lie in a plane
};

/// Returns the point at which the edge p → p' crosses a face.
CRUMPLE_HD inline EdgeCrossing<Enclosed> cross_edge(const Vec3d& p, const Vec3d& p_end, const FaceCorners& face,
                                                    const Vec3<Enclosed>& normal, const KnownZeros& zero) {
    const auto distance = [&](bool is_zero, const Vec3d& x) {
        return is_zero ? Enclosed(0) : dot(normal, enclosed_difference(x, face[0]));
    };
    const Enclosed from = distance(zero.from, p), to = distance(zero.to, p_end), all = from - to;
    const Vec3<Enclosed> along = enclosed_difference(p_end, p);
    // The barycentric coordinate of the corner opposite edge k, from corner q to r.
    const auto coordinate = [&](std::size_t k, const Vec3d& q, const Vec3d& r) {
        if (zero.edge[k]) return Enclosed(0);
        if (zero.edge[next_corner(k)] && zero.edge[next_corner(next_corner(k))]) return Enclosed(1);
        return -(dot(along, cross(enclosed_difference(q, p), enclosed_difference(r, p))) / all);
    };
    return {zero.from ? Enclosed(0)
            : zero.to ? Enclosed(1)
                      : from / all,
            {coordinate(2, face[2], face[0]), coordinate(0, face[0], face[1])}};
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
    const auto cross_edge = [&](const CrossedFace& of, std::size_t i, const CrossedFace& face, const auto& normal,
                                auto sign_of_edges) {
        const Vec3d &p = of.corner[i], &p_end = of.corner[next_corner(i)];
        detail::KnownZeros zero;
        if (signs.tied) {
            zero.from = QuickSigns::sign_of_side(face, p) == 0;
            zero.to = QuickSigns::sign_of_side(face, p_end) == 0;
            for (std::size_t k = 0; k < 3; ++k) zero.edge[k] = sign_of_edges(k) == 0;
        }
        const auto at = detail::cross_edge(p, p_end, face.corner, normal, zero);
        crossing.certain &= detail::may_be_multiplied(at);
        return at;
    };
    add_segment<Enclosed>(
        [&](std::size_t i) {
            return cross_edge(a, i, b, normal_b, [&](std::size_t k) { return signs.sign_of_edges(i, k); });
        },
        [&](std::size_t i) {
            return cross_edge(b, i, a, normal_a, [&](std::size_t k) { return signs.sign_of_edges(k, i); });
        },
        crossing);
    for (std::size_t k = 0; k < 3; ++k)
        crossing.certain &=
            crossing.a[k].error <= detail::largest_weight_error && crossing.b[k].error <= detail::largest_weight_error;
    return crossing;
}

}  // namespace crumple
