#pragma once

// Double-double filter: computes the crossing of two faces of closed surfaces, with the second one shifted
// infinitesimally (face_crossing.h). Signs are exact, by filters and expansions (geometry/predicates.h); numbers are
// double words with error bounds (enclosed.h). Requires coordinates in the range of double words: 0, or between 2^-150
// and 2^150 in magnitude. If bounds are too wide, exact_crossing.h decides. Compiled for host and device.

#include <array>
#include <cstddef>

#include "exact/overlap/crossing.h"
#include "exact/overlap/enclosed.h"
#include "exact/overlap/segment.h"
#include "geometry/predicates.h"
#include "geometry/triangle.h"

namespace crumple {

namespace detail {

/// Returns the exact sign of component `axis` of (q − p) × (s − r). The float64 filter rounds four times.
CRUMPLE_HD inline int cross_sign(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s, int axis) {
    const int x = first_axis(axis), y = second_axis(axis);
    const double plus = (q[x] - p[x]) * (s[y] - r[y]), minus = (q[y] - p[y]) * (s[x] - r[x]);
    const int sign = certain_sign(plus - minus, 5 * epsilon * (std::abs(plus) + std::abs(minus)) + slack);
    if (sign != undecided) return sign;
    if ((q[x] == p[x] || s[y] == r[y]) && (q[y] == p[y] || s[x] == r[x])) return 0;
    return (crumple::exact_difference(q[x], p[x]) * crumple::exact_difference(s[y], r[y]) -
            crumple::exact_difference(q[y], p[y]) * crumple::exact_difference(s[x], r[x]))
        .sign();
}

/// Returns the sign of (q − p) × (s − r) · (e, e², e³), e → 0+.
CRUMPLE_HD inline int first_cross_sign(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
    for (int axis = 0; axis < 3; ++axis)
        if (const int sign = cross_sign(p, q, r, s, axis)) return sign;
    return 0;
}

}  // namespace detail

/// Face with its plane and sign, which all pairs with this face share.
struct CrossedFace {
    FaceCorners corner;
    FilteredPlane plane;
    /// Sign of normal · (e, e², e³), e → 0+; 0 if the face is degenerate.
    int first_sign;

    CRUMPLE_HD explicit CrossedFace(const FaceCorners& p)
        : corner(p), plane(p), first_sign(detail::first_cross_sign(p[0], p[1], p[0], p[2])) {}

    CRUMPLE_HD Vec3<Enclosed> normal() const {
        return cross(enclosed_difference(corner[1], corner[0]), enclosed_difference(corner[2], corner[0]));
    }
};

/// Signs for cross_faces(), each decided once for both shifts. Requires coordinates in the range of double words.
class FilteredCrossingSigns {
   public:
    CRUMPLE_HD FilteredCrossingSigns(const CrossedFace& a, const CrossedFace& b)
        : has_inside_a(a.first_sign != 0), has_inside_b(b.first_sign != 0), a_(a), b_(b) {}

    bool has_inside_a, has_inside_b;
    /// True if a sign came from the shift, so that it is the opposite under the opposite shift.
    bool tied = false;

    /// Sets the direction in which b is shifted.
    CRUMPLE_HD void set(Shift shift) { shift_ = sign_of(shift); }

    CRUMPLE_HD int a_side(std::size_t i) {
        const int sign = sign_of_a(i);
        return sign != 0 ? sign : tie(-b_.first_sign);
    }
    CRUMPLE_HD int b_side(std::size_t i) {
        const int sign = sign_of_b(i);
        return sign != 0 ? sign : tie(a_.first_sign);
    }
    CRUMPLE_HD int edges(std::size_t i, std::size_t j) {
        const int sign = sign_of_edges(i, j);
        if (sign != 0) return sign;
        const auto &p = a_.corner, &q = b_.corner;
        return tie(detail::first_cross_sign(q[j], q[next_corner(j)], p[i], p[next_corner(i)]));
    }

    /// Returns the end of an edge of a (of_b = 0) or b (of_b = 1) that lies exactly in the plane of the other face, or
    /// −1 if neither end does.
    CRUMPLE_HD int vertex(std::size_t of_b, std::size_t edge) {
        const auto in_plane = [&](std::size_t corner) { return (of_b ? sign_of_b(corner) : sign_of_a(corner)) == 0; };
        if (!tied) return -1;
        if (in_plane(edge)) return static_cast<int>(edge);
        return in_plane(next_corner(edge)) ? static_cast<int>(next_corner(edge)) : -1;
    }

    CRUMPLE_HD bool in_plane_of_b(std::size_t i) { return sign_of_a(i) == 0; }

    // Signs without the shift, which may be 0:
    CRUMPLE_HD int sign_of_a(std::size_t i) { return side(b_, a_.corner[i], side_of_a_[i]); }
    CRUMPLE_HD int sign_of_b(std::size_t i) { return side(a_, b_.corner[i], side_of_b_[i]); }
    CRUMPLE_HD int sign_of_edges(std::size_t i, std::size_t j) {
        int& sign = edges_[i][j];
        if (sign != undecided) return sign;
        const Vec3d &p = a_.corner[i], &p_end = a_.corner[next_corner(i)];
        const Vec3d &q = b_.corner[j], &q_end = b_.corner[next_corner(j)];
        return sign = p == q || p == q_end || p_end == q || p_end == q_end ? 0 : orient3d(p, p_end, q, q_end);
    }

   private:
    CRUMPLE_HD int tie(int sign) {
        tied = true;
        return shift_ * sign;
    }
    CRUMPLE_HD static int side(const CrossedFace& face, const Vec3d& p, int& sign) {
        if (sign == undecided) sign = face.plane.side(p);
        const auto& q = face.corner;
        if (sign == undecided) sign = p == q[0] || p == q[1] || p == q[2] ? 0 : orient3d_exact(q[0], q[1], q[2], p);
        return sign;
    }

    const CrossedFace &a_, &b_;
    int shift_ = 1;
    int side_of_a_[3] = {undecided, undecided, undecided}, side_of_b_[3] = {undecided, undecided, undecided};
    int edges_[3][3] = {
        {undecided, undecided, undecided}, {undecided, undecided, undecided}, {undecided, undecided, undecided}};
};

struct FilteredCrossing : Crossing<Enclosed> {
    bool tied = false;  ///< true if the faces may cross differently under the opposite shift
    /// False if the numbers are too uncertain to be worth adding.
    bool certain = true;
};

namespace detail {

/// Largest error bound of a weight that counts as certain, and smallest nonzero quotient whose products cannot
/// underflow.
inline constexpr double largest_weight_error = 0x1p-80, least_quotient = 0x1p-250;

/// Flags for an edge p → p' that crosses a face: true for quantities that are exactly 0 without the shift. If these are
/// set to 0, a crossing at a vertex or on an edge gets parameters and barycentric coordinates of 0 or 1 without error,
/// so sums of such numbers can be 0 with certainty.
struct CertainZeros {
    bool from = false, to = false;                  ///< true if p or p' lies in the plane of the face
    std::array<bool, 3> edge{false, false, false};  ///< true if the edge and edge k of the face are coplanar
};

/// Returns the point at which the edge p → p' crosses a face.
CRUMPLE_HD inline EdgeCrossing<Enclosed> cross_edge(const Vec3d& p, const Vec3d& p_end, const FaceCorners& face,
                                                    const Vec3<Enclosed>& normal, const CertainZeros& zero) {
    const auto distance = [&](bool is_zero, const Vec3d& x) {
        return is_zero ? Enclosed(0) : dot(normal, enclosed_difference(x, face[0]));
    };
    const Enclosed from = distance(zero.from, p), to = distance(zero.to, p_end), all = from - to;
    const Vec3<Enclosed> along = enclosed_difference(p_end, p);
    // Returns the barycentric coordinate of the corner opposite edge k, which runs from q to r.
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

/// Computes the crossing of a and b, with b shifted. Requires coordinates in the range of double words.
CRUMPLE_HD inline FilteredCrossing filter_crossing(const CrossedFace& a, const CrossedFace& b, Shift shift) {
    FilteredCrossing crossing;
    FilteredCrossingSigns signs(a, b);
    signs.set(shift);
    crossing.jumps = cross_faces(signs);
    crossing.tied = signs.tied;
    if (!crossing.jumps.segment) return crossing;
    const Vec3<Enclosed> normal_a = a.normal(), normal_b = b.normal();
    const auto cross_edge = [&](const CrossedFace& of, std::size_t i, const CrossedFace& face, const auto& normal,
                                auto sign_of_corner, auto sign_of_edges) {
        detail::CertainZeros zero;
        if (signs.tied) {
            zero.from = sign_of_corner(i) == 0;
            zero.to = sign_of_corner(next_corner(i)) == 0;
            for (std::size_t k = 0; k < 3; ++k) zero.edge[k] = sign_of_edges(k) == 0;
        }
        const auto at = detail::cross_edge(of.corner[i], of.corner[next_corner(i)], face.corner, normal, zero);
        crossing.certain &= detail::may_be_multiplied(at);
        return at;
    };
    add_segment<Enclosed>(
        [&](std::size_t i) {
            return cross_edge(
                a, i, b, normal_b, [&](std::size_t k) { return signs.sign_of_a(k); },
                [&](std::size_t k) { return signs.sign_of_edges(i, k); });
        },
        [&](std::size_t i) {
            return cross_edge(
                b, i, a, normal_a, [&](std::size_t k) { return signs.sign_of_b(k); },
                [&](std::size_t k) { return signs.sign_of_edges(k, i); });
        },
        crossing);
    for (std::size_t k = 0; k < 3; ++k)
        crossing.certain &=
            crossing.a[k].error <= detail::largest_weight_error && crossing.b[k].error <= detail::largest_weight_error;
    return crossing;
}

}  // namespace crumple
