#pragma once

// Contact of two triangles in different planes: a point or a segment of the planes' common line, correctly rounded.
// Compiled for host and device.
//
// The exact signs of the corners and the order of the edges along the line determine which one or two crossings of an
// edge with a plane are the ends of the intersection. Their coordinates are computed in double words (unevaluated sums
// of two float64 numbers) with a bound on the error; if every number within the bound rounds to the same float64, that
// is the result (A. Ziv's test). If the rounded coordinates of the ends differ, they also determine which end is
// lexicographically smaller, because rounding is monotone; otherwise the sign of the line's direction does.
//
// Cases that stay unresolved, nearly always ties, are passed to `Exact`: two functions that either set the result or
// return false.

#include "exact/intersection/arrangement.h"
#include "exact/intersection/contact.h"
#include "geometry/double_word.h"

namespace crumple {

/// `Exact` for a device, which has no rational arithmetic: resolves nothing.
struct NothingExact {
    /// Sets the result to the point at which the line through p and q crosses the plane of the triangle, correctly
    /// rounded.
    CRUMPLE_HD bool crossing(const Vec3d&, const Vec3d&, const std::array<Vec3d, 3>&, Vec3d&) const { return false; }
    /// Sets the result to the sign of a component of normal(b) × normal(a), the direction of the common line.
    CRUMPLE_HD bool direction(const CommonLine&, int, int&) const { return false; }
};

namespace detail {

/// True if all coordinates are 0 or in a range, which includes float32, in which nothing below over- or underflows:
/// they are multiples of 2^-202, so that products of four differences are multiples of 2^-808.
CRUMPLE_HD inline bool in_double_word_range(const Triangle& t) {
    const auto in_range = [](double x) { return x == 0 || (std::abs(x) >= 0x1p-150 && std::abs(x) <= 0x1p150); };
    for (const Vec3d& p : t.point) {
        if (!in_range(p.x) || !in_range(p.y) || !in_range(p.z)) return false;
    }
    return true;
}

CRUMPLE_HD inline int order(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
    return p == r || p == s || q == r || q == s ? 0 : orient3d(p, q, r, s);
}

CRUMPLE_HD inline bool constant(const std::array<Vec3d, 3>& p, int axis) {
    return p[0][axis] == p[1][axis] && p[0][axis] == p[2][axis];
}

struct AxisDistance {
    DoubleWord value;
    double error;
};

/// Plane in double words. operator() returns the distance of a point times the length of the normal.
class DoubleWordPlane {
   public:
    CRUMPLE_HD explicit DoubleWordPlane(const std::array<Vec3d, 3>& p) : origin_(p[0]) {
        for (int axis = 0; axis < 3; ++axis) {
            const int x = first_axis(axis), y = second_axis(axis);
            const DoubleWord ux = two_sum(p[1][x], -p[0][x]), uy = two_sum(p[1][y], -p[0][y]);
            const DoubleWord vx = two_sum(p[2][x], -p[0][x]), vy = two_sum(p[2][y], -p[0][y]);
            normal_[static_cast<std::size_t>(axis)] = ux * vy - uy * vx;
            magnitude_[axis] = std::abs(ux.high * vy.high) + std::abs(uy.high * vx.high);
        }
    }

    /// Returns the distance times the length of the normal. Differences are exact; each monomial passes five roundings
    /// below 2^-103: two products, a difference, two sums. So the error is below 5.01 · 2^-103 < 2^-100.6 of the sum of
    /// their magnitudes; 2^-100 makes up for computing that sum in float64.
    CRUMPLE_HD AxisDistance operator()(const Vec3d& p) const {
        DoubleWord sum{0, 0};
        double magnitude = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const DoubleWord difference = two_sum(p[axis], -origin_[axis]);
            const DoubleWord term = normal_[static_cast<std::size_t>(axis)] * difference;
            sum = axis == 0 ? term : sum + term;
            magnitude += magnitude_[axis] * std::abs(difference.high);
        }
        return {sum, 0x1p-100 * magnitude};
    }

   private:
    Vec3d origin_;
    std::array<DoubleWord, 3> normal_;
    Vec3d magnitude_;
};

/// Computes the point at which the edge from p to q, which must be strictly on different sides, crosses the triangle's
/// plane, each coordinate correctly rounded. Returns false if `exact` does not resolve it.
///
/// Let d and e be the distances of p and q, E the sum of the bounds on their errors, and D = |d| + |e|. The crossing is
/// p + t (q − p) with t = d / (d − e). Errors of t: at most E / D from those of d and e, because d and e have different
/// signs; less than 2^-100 from rounding the difference and the quotient. Errors of the crossing: |q − p| times those
/// of t; less than 2^-102 |q − p| from rounding the product; less than 2^-103 of the result from rounding the sum. The
/// three bounds on roundings are at least doubled, which makes up for computing the bound itself in float64.
template <class Exact>
CRUMPLE_HD_COLD bool crossing(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& triangle, const Exact& exact,
                              Vec3d& result) {
    const DoubleWordPlane plane(triangle);
    const AxisDistance d = plane(p), e = plane(q);
    const DoubleWord denominator = d.value - e.value;
    const double error = d.error + e.error, distance = std::abs(denominator.high);
    if (!(4 * error < distance)) return exact.crossing(p, q, triangle, result);
    const DoubleWord t = d.value / denominator;
    const double error_of_t = error / distance + 0x1p-98;

    for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] == q[axis] || constant(triangle, axis)) {
            result[axis] = (p[axis] == q[axis] ? p[axis] : triangle[0][axis]) + 0.0;  // −0 becomes +0
            continue;
        }
        const DoubleWord span = two_sum(q[axis], -p[axis]);
        const DoubleWord x = DoubleWord{p[axis], 0} + t * span;
        const double bound = std::abs(span.high) * error_of_t + std::abs(x.high) * 0x1p-102;
        const double low = x.high + (x.low - bound), high = x.high + (x.low + bound);
        if (low != high) return exact.crossing(p, q, triangle, result);
        result[axis] = low + 0.0;
    }
    return true;
}

/// Computes the crossing of edge 0i of a triangle with the plane of the other.
template <class Exact>
CRUMPLE_HD bool crossing(const std::array<Vec3d, 3>& corners, const std::array<int, 3>& sides, std::size_t i,
                         const std::array<Vec3d, 3>& other, const Exact& exact, Vec3d& result) {
    if (sides[0] != 0 && sides[i] != 0) return crossing(corners[0], corners[i], other, exact, result);
    result = (sides[0] == 0 ? corners[0] : corners[i]) + Vec3d{};  // −0 becomes +0
    return true;
}

/// Sets `result` to true if `end` comes before `begin` in lexicographic order; along the line, `begin` comes first.
/// Returns false if `exact` does not resolve that.
template <class Exact>
CRUMPLE_HD bool ends_first(const Vec3d& end, const Vec3d& begin, const CommonLine& line, const Exact& exact,
                           bool& result) {
    result = false;
    for (int axis = 0; axis < 3; ++axis) {
        if (end[axis] != begin[axis]) {
            result = end[axis] < begin[axis];
            return true;
        }
        if (constant(line.a, axis) || constant(line.b, axis)) continue;
        int sign = 0;
        if (!exact.direction(line, axis, sign)) return false;
        if (sign != 0) {
            result = sign < 0;
            return true;
        }
    }
    return true;
}

template <class Exact>
CRUMPLE_HD bool contact_on_line(const CommonLine& line, const Exact& exact, Contact& result) {
    // Along the line, `a` extends from edge 01 to edge 02, and `b` from edge 02 to edge 01.
    const auto& [a0, a1, a2] = line.a;
    const auto& [b0, b1, b2] = line.b;
    const int a_begin_b_end = order(a0, a1, b0, b1), a_end_b_begin = order(a0, a2, b0, b2);
    result.count = 0;
    if (a_begin_b_end > 0 || a_end_b_begin < 0) return true;
    const bool begins_with_b = order(a0, a1, b0, b2) < 0, ends_with_a = order(a0, a2, b0, b1) < 0;
    const bool one_point = begins_with_b ? (ends_with_a ? a_end_b_begin == 0 : line.side_b[0] == 0)
                                         : (ends_with_a ? line.side_a[0] == 0 : a_begin_b_end == 0);
    Vec3d &begin = result.points[0], &end = result.points[1];
    if (!(begins_with_b ? crossing(line.b, line.side_b, 2, line.a, exact, begin)
                        : crossing(line.a, line.side_a, 1, line.b, exact, begin)))
        return false;
    result.count = 1;
    if (one_point) return true;
    if (!(ends_with_a ? crossing(line.a, line.side_a, 2, line.b, exact, end)
                      : crossing(line.b, line.side_b, 1, line.a, exact, end)))
        return false;
    result.count = 2;
    bool turned;
    if (!ends_first(end, begin, line, exact, turned)) return false;
    if (turned) swap_values(begin, end);
    return true;
}

}  // namespace detail

/// Computes the whole intersection of two triangles. Returns false, and leaves `result` undefined, if a coordinate is
/// neither 0 nor within 2^±150 in magnitude, if `exact` does not resolve a case, or if the triangles are coplanar or
/// one is degenerate and no plane of either separates them.
template <class Exact>
CRUMPLE_HD bool contact_on_line(const Triangle& a, const Triangle& b, const Exact& exact, Contact& result) {
    if (!detail::in_double_word_range(a) || !detail::in_double_word_range(b)) return false;
    const Sharing sharing(a, b);
    Sides side_a(FilteredPlane(b.point), a, sharing.a), side_b(FilteredPlane(a.point), b, sharing.b);
    ExactSigns signs;
    side_a.complete(b, a, signs);
    side_b.complete(a, b, signs);
    result.count = 0;
    if (side_a.separated() || side_b.separated()) return true;
    // All sides 0: the triangles are coplanar, or one of them is degenerate.
    if (side_a.zero() || side_b.zero()) return false;
    return detail::contact_on_line(CommonLine(a, b, side_a, side_b), exact, result);
}

}  // namespace crumple
