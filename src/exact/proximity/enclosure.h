#pragma once

// Enclosure of the squared distance of two features between two numbers that agree in about a hundred bits, and the
// results that follow from it. Compiled for host and device. The bounds are derived in docs/nearness_algebra.md.
//
// w, u, v, s and t are those of closest_guess.h, renumbered by vectors_from_guess.h. The guess is used as it is: s and
// t are float64 numbers, so the squared length of w + s u + t v, evaluated in double words (unevaluated sums of two
// float64 numbers), is an upper bound that errors of the guess do not affect. The squared length f is a quadratic
// function of (s, t), so its slopes at the guess bound how much smaller it is elsewhere: not at all along a parameter
// that can only grow and with which f grows, otherwise by at most the square of the slope divided by the curvature. If
// the guess is off by rounding errors, so are the slopes, and the loss is of the order of their squares.
//
// With hardly any curvature, as for nearly parallel edges, this bound is too large. Then slopes are evaluated in double
// words, too, and a step of Newton's method improves the guess.

#include <limits>

#include "exact/proximity/vectors_from_guess.h"
#include "exact/proximity/without_rounding.h"

namespace crumple::detail {

/// Products of numbers above `least_squared` do not underflow; slopes that underflow are below `slope_slack`.
inline constexpr double least_squared = 0x1p-400, slope_slack = 0x1p-500;

/// Half a derivative of f with respect to s or t, with a bound on its error.
struct Slope {
    double value = 0, error = 0;

    CRUMPLE_HD double magnitude() const { return std::abs(value) + error; }
    /// Returns how fast f may fall along the parameter: not at all if the parameter can only grow and f grows with it.
    CRUMPLE_HD double pull(bool free) const { return !free && value >= error ? 0 : magnitude(); }
};

class Enclosure {
   public:
    /// Works with any guess whose parameters are in the domain.
    CRUMPLE_HD Enclosure(const Features& features, const Guess& guess)
        : seen_(features, guess), kinds_(features.kinds), type_(guess.type) {
        const auto& [w, exact_u, exact_v, s, t, free] = seen_;
        const Vec3d u = high(exact_u), v = high(exact_v);
        u_length_ = length_1(u), v_length_ = length_1(v);
        if (free == 0 && length_1(high(w)) == 0) type_ = first_common_vertex(features);
        if (!(length_1(high(w)) + u_length_ + v_length_ <= largest_size)) return;
        uu_ = dot(u, u), uv_ = dot(u, v), vv_ = dot(v, v);
        area_ = (uu_ * vv_ - uv_ * uv_) - 32 * epsilon * (uu_ * vv_);
        g_ = free == 0 ? w : free == 1 ? combine(w, s, exact_u) : combine(w, s, exact_u, t, exact_v);
        if (free > 0) error_ = 17 * epsilon * epsilon * (length_1(high(w)) + s * u_length_ + t * v_length_);
        along_u_ = rounded_slope(u, u_length_), along_v_ = rounded_slope(v, v_length_);
        enclose();
        for (int step = 0; step < 2 && !certainly_touching() && !(below_ <= 0x1p-80 * squared_.high); ++step) refine();
    }

    /// Bounds in real numbers: squared() - below() ≤ squared distance ≤ squared() + above(). Both errors are infinite
    /// if nothing is proven.
    CRUMPLE_HD DoubleWord squared() const { return squared_; }
    CRUMPLE_HD double below() const { return below_; }
    CRUMPLE_HD double above() const { return above_; }

    /// Return true if the features certainly have a point in common (touching), or certainly have none (apart).
    CRUMPLE_HD bool touching() {
        if (certainly_touching()) return true;
        return !apart() && decide_type() && certainly_touching();
    }
    CRUMPLE_HD bool apart() const { return below_ < 0.5 * squared_.high; }

    CRUMPLE_HD Proximity compare(const DistanceLimit& reach) {
        const int order = compare_with(two_sum(reach.a, reach.b));
        if (order == undecided) return Proximity::unknown;
        return order < 0 || (order == 0 && !reach.strict) ? Proximity::within : Proximity::beyond;
    }

    /// True if the rounded squared distance is certain; then sets `rounded` to it.
    CRUMPLE_HD bool squared_rounded(double& rounded) {
        const auto certain = [&] {
            rounded = squared_.high + (squared_.low + above_);
            return squared_.high + (squared_.low - below_) == rounded;
        };
        return certain() || (decide_type() && certain());
    }

    /// True if it is certain which float64 is the largest not above the distance; then sets `rounded` to it.
    CRUMPLE_HD bool rounded_down(double& rounded) {
        if (touching()) return rounded = 0, true;
        if (!apart()) return false;
        rounded = std::sqrt(squared_.high);
        int order = compare_with({rounded, 0});
        if (order == -1) {
            rounded = std::nextafter(rounded, 0.0);
            return order = compare_with({rounded, 0}), order == 0 || order == 1;
        }
        return order == 0 || (order == 1 && compare_with({std::nextafter(rounded, largest_size), 0}) == -1);
    }

    /// True if the closest points are certain; then sets `points` to them.
    CRUMPLE_HD bool closest(ClosestPoints& points) {
        if (!certainly_touching() && apart()) {
            Enclosure precise = *this;
            if (!refined_) precise.refine();
            points.type = type_;
            if (precise.type_certain() && precise.parameters(points.at)) return true;
        }
        points.type = type_;
        return decide_type() && is_exact_type_certain() && parameters(points.at);
    }

   private:
    enum class Exactness : std::uint8_t { untried, no, yes };

    static constexpr double epsilon = near_epsilon;

    CRUMPLE_HD Slope rounded_slope(const Vec3d& along, double length) const {
        const Vec3d g = high(g_);
        return {dot(g, along), (6 * epsilon * largest(abs(g)) + 1.1 * error_) * length + slope_slack};
    }
    CRUMPLE_HD Slope slope(const Vec3dw& along, double length) const {
        const DoubleWord value = dot_product(g_, along);
        const double error = (25 * epsilon * epsilon * largest(abs(high(g_))) + 1.1 * error_) * length;
        return {value.high, error + 2 * epsilon * std::abs(value.high) + slope_slack};
    }

    CRUMPLE_HD bool curved() const { return uu_ > least_squared && vv_ > least_squared && area_ > 0; }
    CRUMPLE_HD double pull_u() const { return u_length_ == 0 ? 0 : along_u_.pull(seen_.free > 0); }
    CRUMPLE_HD double pull_v() const { return v_length_ == 0 ? 0 : along_v_.pull(seen_.free > 1); }

    /// Returns a bound on how much smaller than at (s, t) f may be in the domain.
    CRUMPLE_HD double loss() const {
        const double by_u = pull_u(), by_v = pull_v();
        if (by_u == 0 && by_v == 0) return 0;
        const double uncurved = 2.1 * (by_u + by_v);  // as no parameter moves by more than 1
        if (v_length_ == 0) return uu_ > least_squared ? min(uncurved, 1.1 * by_u * by_u / uu_) : uncurved;
        return curved() ? min(uncurved, 2.25 * (by_u * by_u * vv_ + by_v * by_v * uu_) / area_) : uncurved;
    }

    CRUMPLE_HD void enclose() {
        squared_ = dot_product(g_, g_);
        if (seen_.free == 0 && length_1(high(g_)) == 0) {
            below_ = above_ = 0;
        } else if (squared_.high >= least_squared && squared_.high <= largest_size * largest_size) {
            above_ = 32 * epsilon * epsilon * squared_.high + (2.1 * length_1(high(g_)) + error_) * error_;
            below_ = above_ + loss();
        }
    }

    /// Improves the guess by a step of Newton's method, with slopes in double words.
    CRUMPLE_HD_COLD void refine() {
        const Slope along_u = slope(seen_.u, u_length_), along_v = slope(seen_.v, v_length_);
        double s_step = 0, t_step = 0;
        if (seen_.free == 1 && uu_ > least_squared) s_step = -along_u.value / uu_;
        if (seen_.free == 2 && curved()) {
            s_step = (uv_ * along_v.value - vv_ * along_u.value) / area_;
            t_step = (uv_ * along_u.value - uu_ * along_v.value) / area_;
        }
        keep_inside(s_step, t_step);
        s_low_ += s_step, t_low_ += t_step;
        const Vec3d step = s_step * high(seen_.u) + t_step * high(seen_.v);
        g_ = {added(g_.x, step.x), added(g_.y, step.y), added(g_.z, step.z)};
        const double moved =
            (std::abs(s_step) + std::abs(s_low_)) * u_length_ + (std::abs(t_step) + std::abs(t_low_)) * v_length_;
        error_ += 8 * epsilon * moved + 4 * epsilon * epsilon * (length_1(high(g_)) + moved);
        const auto after = [&](const Slope& before, double change, double length) {
            return Slope{before.value + change,
                         before.error + 4 * epsilon * std::abs(before.value) + 16 * epsilon * length * moved};
        };
        along_u_ = after(along_u, s_step * uu_ + t_step * uv_, u_length_);
        along_v_ = after(along_v, s_step * uv_ + t_step * vv_, v_length_);
        refined_ = true;
        enclose();
    }

    CRUMPLE_HD static DoubleWord added(DoubleWord x, double y) {
        const TwoTerms sum = two_sum(x.high, y);
        return two_sum(sum.high, sum.low + x.low);
    }

    /// Limits the steps to the domain; sets them to 0 if they are not small or would leave its inside.
    CRUMPLE_HD void keep_inside(double& s_step, double& t_step) const {
        const double s = seen_.s + s_low_, t = seen_.t + t_low_;
        constexpr double largest_step = 0x1p-10;
        if (seen_.free == 1) s_step = max(-s, min((1 - seen_.s) - s_low_, s_step));
        const bool small = std::abs(s_step) <= largest_step && std::abs(t_step) <= largest_step;
        const double margin = 16 * epsilon;
        const bool inside =
            seen_.free < 2 ||
            (s + s_step > margin && t + t_step > margin && s + s_step < 1 - margin && t + t_step < 1 - margin &&
             (kinds_ == FeatureKinds::edge_edge || (s + t) + (s_step + t_step) < 1 - margin));
        if (!small || !inside) s_step = t_step = 0;
    }

    /// Return bounds on the errors of the parameters, if the true ones are inside the domain.
    CRUMPLE_HD double s_error() const {
        return seen_.free == 2 ? 1.1 * (along_u_.magnitude() * vv_ + along_v_.magnitude() * std::abs(uv_)) / area_
                               : 1.1 * along_u_.magnitude() / uu_;
    }
    CRUMPLE_HD double t_error() const {
        return 1.1 * (along_v_.magnitude() * uu_ + along_u_.magnitude() * std::abs(uv_)) / area_;
    }

    /// True if the closest points are certainly unique, and on the parts of `type_`, but not on smaller ones.
    CRUMPLE_HD bool type_certain() const {
        const bool two = kinds_ == FeatureKinds::vertex_face || kinds_ == FeatureKinds::edge_edge;
        if (seen_.free == 2) {
            if (!curved()) return false;
            const double s = seen_.s + s_low_, t = seen_.t + t_low_, s_off = s_error() + 4 * epsilon,
                         t_off = t_error() + 4 * epsilon;
            return s > s_off && t > t_off &&
                   (kinds_ == FeatureKinds::vertex_face ? s + t + s_off + t_off < 1 - 4 * epsilon
                                                        : s + s_off < 1 && t + t_off < 1);
        }
        if (seen_.free == 1) {
            if (!(uu_ > least_squared)) return false;
            const double s = seen_.s + s_low_, off = s_error() + 4 * epsilon;
            return s > off && s + off < 1 &&
                   (!two || along_v_.value > along_v_.error + 1.1 * off * u_length_ * v_length_);
        }
        return kinds_ == FeatureKinds::vertex_vertex ||
               (along_u_.value > along_u_.error && (!two || along_v_.value > along_v_.error));
    }

    /// Computes the parameters of ClosestPoints, each of which is 0, 1, s, t or 1 - s. Returns false if their rounding
    /// is not certain.
    CRUMPLE_HD bool parameters(std::array<double, 2>& at) const {
        constexpr const char* face[] = {"00", "10", "01", "s0", "cs", "0s", "st"};
        constexpr const char* edges[] = {"00", "01", "10", "11", "s0", "s1", "0s", "1s", "st"};
        constexpr const char* edge[] = {"00", "10", "s0"};
        const char* const names = kinds_ == FeatureKinds::vertex_face   ? face[type_]
                                  : kinds_ == FeatureKinds::edge_edge   ? edges[type_]
                                  : kinds_ == FeatureKinds::vertex_edge ? edge[type_]
                                                                        : "00";
        bool certain = true;
        for (std::size_t i = 0; i < 2; ++i) {
            const char name = names[i];
            if (name == '0' || name == '1') {
                at[i] = name == '0' ? 0 : 1;
                continue;
            }
            const DoubleWord x = name == 't' ? two_sum(seen_.t, t_low_) : two_sum(seen_.s, s_low_);
            const double slack =
                settled_ == Exactness::yes ? 0 : 1.1 * (name == 't' ? t_error() : s_error()) + 8 * epsilon * epsilon;
            const TwoTerms high = name == 'c' ? two_sum(1, -x.high) : TwoTerms{x.high, 0};
            const double low = high.low + (name == 'c' ? -x.low : x.low);
            at[i] = high.high + (low + slack);
            certain = certain && high.high + (low - slack) == at[i];
        }
        return certain;
    }

    /// Returns the sign of the distance minus x, x ≥ 0, or `undecided`.
    CRUMPLE_HD int compare_with(TwoTerms x) {
        if (!(x.high <= largest_size))
            return squared_.high + above_ < 0.5 * largest_size * largest_size ? -1 : undecided;
        if (certainly_touching()) return x.high > 0 ? -1 : 0;
        const TwoTerms square = two_product(x.high, x.high);
        const DoubleWord difference = squared_ - fast_two_sum(square.high, square.low + 2 * (x.high * x.low));
        const double size = (1 - 4 * epsilon) * std::abs(difference.high),
                     slack = 16 * epsilon * epsilon * square.high + near_slack;
        if (difference.high > 0 && size > below_ + slack) return 1;
        if (difference.high < 0 && size > above_ + slack) return -1;
        if (!in_expansion_range(x.high) || !in_expansion_range(x.low) || !decide_type()) return undecided;
        return compare_with_square_exactly(squared_, x);
    }

    CRUMPLE_HD bool certainly_touching() const { return squared_.high == 0 && above_ == 0; }

    /// Decides, once, if nothing was rounded; if so, shrinks the enclosure to one number. Returns true if nothing was.
    CRUMPLE_HD bool decide_type() {
        if (settled_ == Exactness::untried) {
            const bool exact = certainly_touching() || (s_low_ == 0 && t_low_ == 0 && is_exact(seen_, g_, squared_));
            settled_ = exact ? Exactness::yes : Exactness::no;
            if (exact) below_ = above_ = 0;
        }
        return settled_ == Exactness::yes;
    }

    /// True if the type is certain, after decide_type() has returned true. As nothing was rounded, the guess is a
    /// closest point. It is the only one if f is curved, and it lies on no smaller part if it is inside.
    CRUMPLE_HD bool is_exact_type_certain() const {
        if (certainly_touching() && seen_.free == 0) return true;
        const double s = seen_.s, t = seen_.t;
        const bool inside = (seen_.free < 1 || (s > 0 && s < 1)) && (seen_.free < 2 || (t > 0 && t < 1));
        return inside && (kinds_ == FeatureKinds::vertex_edge ? uu_ > least_squared : curved());
    }

    VectorsFromGuess seen_;
    double s_low_ = 0, t_low_ = 0;  ///< corrections to s and t of the guess
    Vec3dw g_{};                    ///< w + s u + t v
    double error_ = 0;              ///< bound on the sum of the errors of g_'s components
    Slope along_u_, along_v_;
    double u_length_ = 0, v_length_ = 0, uu_ = 0, uv_ = 0, vv_ = 0;
    double area_ = 0;  ///< lower bound on uu vv - uv²
    DoubleWord squared_{};
    double below_ = std::numeric_limits<double>::infinity(), above_ = below_;
    FeatureKinds kinds_;
    std::uint8_t type_;
    bool refined_ = false;
    Exactness settled_ = Exactness::untried;
};

}  // namespace crumple::detail
