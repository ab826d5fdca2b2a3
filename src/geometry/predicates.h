#pragma once

// Orientation predicates: signs of determinants of differences, in steps. First float64 with an error bound; then, on
// the host, 128-bit integers, if all differences are exact and fit in 41 bits at a common power of two; then
// expansions. Compiled for host and device.
//
// Filters are correct for every finite input, also if products overflow or underflow: they return `undecided` rather
// than a wrong sign. They cost a few nanoseconds. Expansions are exact for coordinates that are 0 or between 2^-300 and
// 2^300 in magnitude, which includes every float32 number: such coordinates are multiples of 2^-352, so products of
// three differences are multiples of 2^-1056, and sums of six are below 2^906. So no rounding error is too small for
// float64, and no term, even if split after Dekker, is too large. Beyond that range exact_intersection.h decides.
//
// The bounds: let ε = 2^-53. Each monomial of a determinant passes k roundings, those of the differences included, so
// the result is off by at most ((1 + ε)^k − 1) P, where P is the sum of the monomials' magnitudes; computing P the same
// way yields at least (1 − ε)^k P. So (k + 1) ε times the computed P is an upper bound. A product that underflows is
// off by at most 2^-1075 more, times the factors by which it is multiplied afterwards; a slack of 2^-1022 times these
// factors covers all such products. Comparisons are written so that infinities and NaN leave the sign undecided.

#include <array>
#include <bit>
#include <cstdint>

#include "geometry/expansion.h"
#include "geometry/vec.h"

namespace crumple {

inline constexpr int undecided = 2;  ///< value of a sign that is otherwise −1, 0 or 1

namespace detail {
inline constexpr double epsilon = 0x1p-53, slack = 0x1p-1022;

CRUMPLE_HD inline int certain_sign(double value, double bound) {
    return value > bound ? 1 : value < -bound ? -1 : undecided;
}
}  // namespace detail

/// True if coordinates are in the range of expansions: 0, or between 2^-300 and 2^300 in magnitude.
CRUMPLE_HD inline bool in_expansion_range(double x) {
    const double magnitude = std::abs(x);
    return (magnitude == 0) | ((magnitude >= 0x1p-300) & (magnitude <= 0x1p300));  // without branches
}
CRUMPLE_HD inline bool in_expansion_range(const Vec3d& p) {
    return in_expansion_range(p.x) && in_expansion_range(p.y) && in_expansion_range(p.z);
}

/// Oriented plane of a triangle in float64: the side to which (p1 − p0) × (p2 − p0) points is positive.
class FilteredPlane {
   public:
    CRUMPLE_HD explicit FilteredPlane(const std::array<Vec3d, 3>& p) : origin_(p[0]) {
        const Vec3d u = p[1] - p[0], v = p[2] - p[0];
        const Vec3d plus{u.y * v.z, u.z * v.x, u.x * v.y}, minus{u.z * v.y, u.x * v.z, u.y * v.x};
        normal_ = plus - minus;
        magnitude_ = abs(plus) + abs(minus);
    }

    /// Returns the side of a point, 1 or −1, or `undecided`. A monomial passes eight roundings: three differences, two
    /// products, a difference, two sums.
    CRUMPLE_HD int side(const Vec3d& p) const {
        const Distance from_plane = distance(p);
        return detail::certain_sign(from_plane.value, from_plane.error);
    }

    /// Distance from the plane, times twice the triangle's area, and a bound on its error.
    struct Distance {
        double value, error;
    };
    CRUMPLE_HD Distance distance(const Vec3d& p) const {
        const Vec3d d = p - origin_, size = abs(d);
        return {dot(normal_, d),
                9 * detail::epsilon * dot(magnitude_, size) + detail::slack * (size.x + size.y + size.z + 1)};
    }

    /// Returns the axis along which the triangle's projection is largest; any axis if the triangle is very small.
    CRUMPLE_HD int dominant_axis() const {
        const Vec3d n = abs(normal_);
        return n.x > n.y ? (n.x > n.z ? 0 : 2) : (n.y > n.z ? 1 : 2);
    }
    /// Returns twice the area of that projection, rounded.
    CRUMPLE_HD double largest_component() const { return std::abs(normal_[dominant_axis()]); }

   private:
    Vec3d origin_, normal_, magnitude_;
};

/// Return the two axes other than `dropped`, in the order in which a turn is positive if it is counter-clockwise about
/// the dropped axis.
CRUMPLE_HD constexpr int first_axis(int dropped) { return dropped == 2 ? 0 : dropped + 1; }
CRUMPLE_HD constexpr int second_axis(int dropped) { return dropped == 0 ? 2 : dropped - 1; }

/// Returns the sign of component `dropped` of (b − a) × (c − a), that is, of the turn a, b, c seen along that axis, or
/// `undecided`. A monomial passes four roundings.
CRUMPLE_HD inline int orient2d_filtered(const Vec3d& a, const Vec3d& b, const Vec3d& c, int dropped) {
    const int x = first_axis(dropped), y = second_axis(dropped);
    const double plus = (b[x] - a[x]) * (c[y] - a[y]), minus = (b[y] - a[y]) * (c[x] - a[x]);
    return detail::certain_sign(plus - minus, 5 * detail::epsilon * (std::abs(plus) + std::abs(minus)) + detail::slack);
}

/// Returns the sign of (b − a) × (c − a) · (d − a), positive if a, b, c turn counter-clockwise seen from d, or
/// `undecided`.
CRUMPLE_HD inline int orient3d_filtered(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return FilteredPlane({a, b, c}).side(d);
}

#ifndef __CUDA_ARCH__
namespace detail {

__extension__ using WideInteger = __int128;

/// Differences of numbers in the range of expansions, as integers times a common power of two.
template <std::size_t size>
class WholeDifferences {
   public:
    void add(double p, double q) {
        const TwoTerms difference = two_sum(p, -q);
        exact_ = exact_ && difference.low == 0;
        value_[count_++] = difference.high;
    }
    /// Scales all differences so that the largest is below 2^41. Returns false if a difference is not exact, or is not
    /// an integer after scaling.
    bool make_whole() {
        double most = 0;
        for (const double x : value_) most = max(most, std::abs(x));
        if (!exact_) return false;
        if (most == 0) return true;
        // The power of two that scales `most` to between 2^40 and 2^41.
        const auto exponent = std::bit_cast<std::uint64_t>(most) >> 52;
        const auto scale = std::bit_cast<double>((std::uint64_t{1023 + 1023 + 40} - exponent) << 52);
        for (std::size_t i = 0; i < size; ++i) {
            const double x = value_[i] * scale;
            whole_[i] = static_cast<std::int64_t>(x);
            if (static_cast<double>(whole_[i]) != x) return false;
        }
        return true;
    }
    WideInteger operator[](std::size_t i) const { return whole_[i]; }

   private:
    std::array<double, size> value_{};
    std::array<std::int64_t, size> whole_{};
    std::size_t count_ = 0;
    bool exact_ = true;
};

inline int sign_of(WideInteger x) { return (x > 0) - (x < 0); }

/// Returns the sign of (b − a) × (c − a) in the plane of axes x and y, or `undecided` if 128-bit integers do not
/// suffice.
inline int orient2d_whole(const Vec3d& a, const Vec3d& b, const Vec3d& c, int x, int y) {
    WholeDifferences<4> d;
    for (const Vec3d* const p : {&b, &c})
        for (const int axis : {x, y}) d.add((*p)[axis], a[axis]);
    return d.make_whole() ? sign_of(d[0] * d[3] - d[1] * d[2]) : undecided;
}
/// Returns the sign of (b − a) × (c − a) · (d − a), or `undecided` if 128-bit integers do not suffice. Six products
/// below 2^123.
inline int orient3d_whole(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    WholeDifferences<9> w;
    for (const Vec3d* const p : {&b, &c, &d})
        for (int axis = 0; axis < 3; ++axis) w.add((*p)[axis], a[axis]);
    if (!w.make_whole()) return undecided;
    const auto minor = [&](std::size_t y, std::size_t z) { return w[y] * w[3 + z] - w[z] * w[3 + y]; };
    return sign_of(minor(1, 2) * w[6] + minor(2, 0) * w[7] + minor(0, 1) * w[8]);
}

/// True if all four points have the same coordinate on some axis, or two are equal: they certainly lie in one plane.
inline bool certainly_coplanar(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const auto same = [&](int axis) { return a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]; };
    return same(0) || same(1) || same(2) || a == d || b == d || c == d || a == b || a == c || b == c;
}
/// True if each product in the determinant (b − a) × (c − a), in the plane of axes x and y, has a factor 0.
inline bool certainly_collinear(const Vec3d& a, const Vec3d& b, const Vec3d& c, int x, int y) {
    return (b[x] == a[x] || c[y] == a[y]) && (b[y] == a[y] || c[x] == a[x]);
}

}  // namespace detail
#endif

/// Returns the exact sign of component `dropped` of (b − a) × (c − a), by expansions. Takes up to 1 us, and some
/// kilobytes of stack.
CRUMPLE_HD_COLD inline int orient2d_expansion(const Vec3d& a, const Vec3d& b, const Vec3d& c, int dropped) {
    const int x = first_axis(dropped), y = second_axis(dropped);
    return (exact_difference(b[x], a[x]) * exact_difference(c[y], a[y]) -
            exact_difference(b[y], a[y]) * exact_difference(c[x], a[x]))
        .sign();
}

/// Computes the summand of axis x in the dot product (b − a) × (c − a) · (d − a); y and z are the other two axes. A
/// separate function, so that the three summands of a determinant use the same stack for their intermediate expansions:
/// threads of a device have little stack.
CRUMPLE_HD_COLD inline void orient3d_term(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, int x, int y,
                                          int z, Expansion<64>& term) {
    const auto uy = exact_difference(b[y], a[y]), uz = exact_difference(b[z], a[z]);
    const auto vy = exact_difference(c[y], a[y]), vz = exact_difference(c[z], a[z]);
    term = (uy * vz - uz * vy) * exact_difference(d[x], a[x]);
}

CRUMPLE_HD_COLD inline int orient3d_expansion(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    Expansion<64> x, y, z;
    orient3d_term(a, b, c, d, 0, 1, 2, x);
    orient3d_term(a, b, c, d, 1, 2, 0, y);
    orient3d_term(a, b, c, d, 2, 0, 1, z);
    return (x + y + z).sign();
}

/// Return the exact signs of the determinants of orient2d_filtered() and orient3d_filtered(), without trying these
/// filters. Coordinates must be in the range of expansions.
CRUMPLE_HD inline int orient2d_exact(const Vec3d& a, const Vec3d& b, const Vec3d& c, int dropped) {
#ifndef __CUDA_ARCH__
    const int x = first_axis(dropped), y = second_axis(dropped);
    if (detail::certainly_collinear(a, b, c, x, y)) return 0;
    if (const int sign = detail::orient2d_whole(a, b, c, x, y); sign != undecided) return sign;
#endif
    return orient2d_expansion(a, b, c, dropped);
}
CRUMPLE_HD inline int orient3d_exact(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
#ifndef __CUDA_ARCH__
    if (detail::certainly_coplanar(a, b, c, d)) return 0;
    if (const int sign = detail::orient3d_whole(a, b, c, d); sign != undecided) return sign;
#endif
    return orient3d_expansion(a, b, c, d);
}

/// Return the exact signs of the determinants of orient2d_filtered() and orient3d_filtered(): by these filters if they
/// decide, in about 10 ns, otherwise by exact arithmetic. Coordinates must be in the range of expansions.
CRUMPLE_HD inline int orient2d(const Vec3d& a, const Vec3d& b, const Vec3d& c, int dropped) {
    const int sign = orient2d_filtered(a, b, c, dropped);
    return sign != undecided ? sign : orient2d_exact(a, b, c, dropped);
}
CRUMPLE_HD inline int orient3d(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const int sign = orient3d_filtered(a, b, c, d);
    return sign != undecided ? sign : orient3d_exact(a, b, c, d);
}

}  // namespace crumple
