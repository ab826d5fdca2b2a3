#pragma once

// Volume f = (u x v) . w of two moving features, which is 0 whenever they touch; u, v and w are the vectors of
// approach.h. It is a cubic in time, represented by its Bernstein coefficients over [0, 1] in float64, with an error
// bound, and evaluated in double words (unevaluated sums of two float64 numbers) at single times. Compiled for host and
// device. Bounds are derived in docs/motion_filters.md.

#include "exact/impact/approach.h"
#include "geometry/double_word.h"

namespace crumple {

CRUMPLE_HD inline double lerp(double a, double b, double t) { return (1 - t) * a + t * b; }

class Volume {
   public:
    struct Slope {
        double value, derivative;
    };

    template <FeaturePair pair>
    CRUMPLE_HD explicit Volume(const Approach<pair>& x) : bound_(32 * detail::epsilon * x.magnitude + x.slack) {
        const Vec3d n0 = cross(x.u.start, x.v.start), n2 = cross(x.u.end, x.v.end);
        const Vec3d n1 = cross(x.u.start, x.v.end) + cross(x.u.end, x.v.start);  // twice the coefficient
        b0_ = dot(n0, x.w.start);
        b1_ = 1. / 3 * (dot(n0, x.w.end) + dot(n1, x.w.start));
        b2_ = 1. / 3 * (dot(n1, x.w.end) + dot(n2, x.w.start));
        b3_ = dot(n2, x.w.end);
    }

    /// Returns the error bound of any value or coefficient computed here.
    CRUMPLE_HD double bound() const { return bound_; }
    CRUMPLE_HD double derivative_bound() const { return 7 * bound_; }

    /// Returns the sign of a value or coefficient if it is certain, otherwise 0.
    CRUMPLE_HD int sign(double value) const { return value > bound_ ? 1 : value < -bound_ ? -1 : 0; }
    CRUMPLE_HD int sign_at_start() const { return sign(b0_); }

    CRUMPLE_HD bool never_zero() const {
        const int first = sign(b0_);
        return first != 0 && sign(b1_) == first && sign(b2_) == first && sign(b3_) == first;
    }

    CRUMPLE_HD Slope slope(double t) const {
        const double c0 = lerp(b0_, b1_, t), c1 = lerp(b1_, b2_, t), c2 = lerp(b2_, b3_, t);
        const double d0 = lerp(c0, c1, t), d1 = lerp(c1, c2, t);
        return {lerp(d0, d1, t), 3 * (d1 - d0)};
    }

    /// Returns a bound on the magnitude of the second derivative.
    CRUMPLE_HD double bend() const {
        return 6 * max(std::abs(b0_ - 2 * b1_ + b2_), std::abs(b1_ - 2 * b2_ + b3_)) + 16 * bound_;
    }

    /// Returns the Bernstein coefficients over [low, high].
    CRUMPLE_HD std::array<double, 4> coefficients(double low, double high) const {
        const double l0 = lerp(b0_, b1_, low), l1 = lerp(b1_, b2_, low), l2 = lerp(b2_, b3_, low);
        const double h0 = lerp(b0_, b1_, high), h1 = lerp(b1_, b2_, high), h2 = lerp(b2_, b3_, high);
        const double ll0 = lerp(l0, l1, low), ll1 = lerp(l1, l2, low);
        const double hh0 = lerp(h0, h1, high), hh1 = lerp(h1, h2, high);
        return {lerp(ll0, ll1, low), lerp(ll0, ll1, high), lerp(hh0, hh1, low), lerp(hh0, hh1, high)};
    }

   private:
    double b0_, b1_, b2_, b3_;
    double bound_;
};

namespace detail {

/// Returns x y with an error of at most 3 u² (algorithm 8 of Joldes, Muller and Popescu).
CRUMPLE_HD inline DoubleWord times(DoubleWord x, double y) {
    const TwoTerms high = two_product(x.high, y);
    return fast_two_sum(high.high, high.low + x.low * y);
}

CRUMPLE_HD inline DoubleWord difference_at(double from_start, double from_end, double to_start, double to_end,
                                           double t) {
    const DoubleWord start = two_sum(to_start, -from_start), end = two_sum(to_end, -from_end);
    return start + times(end - start, t);
}

}  // namespace detail

/// Returns the error bound of precise_volume().
template <FeaturePair pair>
CRUMPLE_HD inline double precise_volume_bound(const Approach<pair>& x) {
    return 0x1p-98 * x.magnitude + x.slack;
}

/// Returns the volume at t, in double words.
template <FeaturePair pair>
CRUMPLE_HD inline DoubleWord precise_volume(const FourPoints& points, double t) {
    const auto [u, v, w] = vectors<pair>(points, [t](const MovingPoint& to, const MovingPoint& from) {
        Vec3<DoubleWord> difference;
        for (int i = 0; i < 3; ++i)
            difference[i] = detail::difference_at(from.start[i], from.end[i], to.start[i], to.end[i], t);
        return difference;
    });
    return dot(cross(u, v), w);
}

}  // namespace crumple
