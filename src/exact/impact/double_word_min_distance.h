#pragma once

// Double-double filter: computes when two moving features first come within a minimum distance, in double words
// (unevaluated sums of two float64 numbers) with proven bounds (docs/separation_filters.md). It decides features that
// come close, after surely_farther.h has advanced to shortly before the contact. Compiled for host and device.
//
// A direction that turns with time proves that the features are farther apart than the minimum distance up to some
// float64 time, and two of their points prove that they are closer at the next float64. The earlier of these times is
// then the result, rounded down; no roots of polynomials have to be isolated. Differences and their domain are those of
// moving_difference.h; the height of a difference is its projection on the direction.

#include "exact/impact/filtered_impact.h"
#include "exact/impact/min_distance.h"
#include "exact/impact/surely_farther.h"
#include "exact/proximity/double_word_vec.h"

namespace crumple::detail {

/// Bound on the error of everything computed below, relative to the sum of the magnitudes of its terms.
inline constexpr double word_error = 0x1p-97;

CRUMPLE_HD inline DoubleWord word(double x) { return {x, 0}; }
CRUMPLE_HD inline Vec3dw scaled(DoubleWord s, const Vec3dw& p) { return {s * p.x, s * p.y, s * p.z}; }

/// Lower and upper bound on the square of the requested minimum distance.
struct SquaredLimit {
    DoubleWord low, high;
};

template <FeatureKinds kinds>
class DoubleWordMinDistance {
   public:
    CRUMPLE_HD DoubleWordMinDistance(const std::array<MovingPoint, 4>& points, const MovingDifference<kinds>& rounded)
        : rounded_difference_(rounded) {
        const auto& [p, q, r, s] = points;
        const auto subtract = [](const Vec3d& x, const Vec3d& y) { return exact_difference(x, y); };
        start_ = difference<kinds>(p.start, q.start, r.start, s.start, subtract);
        end_ = difference<kinds>(p.end, q.end, r.end, s.end, subtract);
    }

    /// Decides the query. `distance`: at least the requested minimum distance. `far`: the time up to which float64
    /// proves that the features are farther apart than `distance`.
    CRUMPLE_HD FilteredImpact decide(const MinDistance& separation, FarTime far, double distance) const {
        const Shortest at_start = shortest(0);
        SquaredLimit limit;
        if (!squared_limit(separation, at_start, limit)) return {};
        if (!far.any) {
            if (closer(at_start, 0, limit)) return {Certainty::meets, 0, true};
            if (!farther_between(at_start, 0, at_start, 0, limit)) return {};
            far.any = true;
        }
        // If features move apart again just before they reach the distance, double words prove that they stay apart
        // until shortly after that time, and float64 continues from there.
        constexpr int most_passes = 2;
        for (int passes = 0;; ++passes) {
            const Shortest before = shortest(far.until);
            const FilteredImpact found = contact_after(before, far.until, limit);
            if (found.verdict != Certainty::unknown || passes == most_passes) return found;
            const double past = far_past(before, far.until, limit);
            if (!(past > far.until)) return {};
            far = far_time(rounded_difference_, distance, {true, past});
            if (far.until == 1) return {Certainty::apart};
        }
    }

   private:
    /// Approximately shortest difference g at some time, and its parameters (s, t) in the domain.
    struct Shortest {
        Vec3dw g;
        DoubleWord s, t;

        /// Returns g scaled to a length of about 1.
        CRUMPLE_HD Vec3dw direction() const {
            const Vec3d rounded = high(g);
            return scaled(word(1 / std::sqrt(dot(rounded, rounded))), g);
        }
    };

    CRUMPLE_HD Difference<DoubleWord> at(double t) const {
        const DoubleWord before = two_sum(1, -t);
        const auto mix = [&](const Vec3dw& x, const Vec3dw& y) { return scaled(before, x) + scaled(word(t), y); };
        return {mix(start_.w, end_.w), mix(start_.u, end_.u), mix(start_.v, end_.v)};
    }

    CRUMPLE_HD static Vec3dw combine(const Difference<DoubleWord>& x, DoubleWord s, DoubleWord t) {
        return x.w + (scaled(s, x.u) + scaled(t, x.v));
    }

    /// Returns the shortest difference at a time: the float64 guess, improved by one step of Newton's method.
    CRUMPLE_HD Shortest shortest(double time) const {
        const DomainPoint guess = closest<kinds>(rounded_difference_.at(time));
        const Difference<DoubleWord> x = at(time);
        const Vec3d u = high(x.u), v = high(x.v);
        if (guess.inside) {
            const Vec3dw g = combine(x, word(guess.s), word(guess.t));
            const double along_u = dot_product(g, x.u).high, along_v = dot_product(g, x.v).high;
            const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), area = uu * vv - uv * uv;
            const double ds = (uv * along_v - vv * along_u) / area, dt = (uv * along_u - uu * along_v) / area;
            const bool inside = guess.s + ds > 0 && guess.t + dt > 0 &&
                                (corners<kinds> == 4 ? guess.s + ds < 1 && guess.t + dt < 1
                                                     : (guess.s + guess.t) + (ds + dt) < 1 - 0x1p-50);
            const DoubleWord s = two_sum(guess.s, inside ? ds : 0), t = two_sum(guess.t, inside ? dt : 0);
            return {combine(x, s, t), s, t};
        }
        const auto on_side = [&](DoubleWord r) {
            const auto place = [&](double from, double step) { return word(from) + word(step) * r; };
            const DoubleWord s = place(guess.s, guess.ds), t = place(guess.t, guess.dt);
            return Shortest{combine(x, s, t), s, t};
        };
        const Shortest first = on_side(word(guess.r));
        if (!(guess.r > 0 && guess.r < 1)) return first;
        const Vec3dw along = scaled(word(guess.ds), x.u) + scaled(word(guess.dt), x.v);
        const double step = -dot_product(first.g, along).high / dot_product(along, along).high;
        const bool inside = guess.r + step > 0 && guess.r + step < 1;
        return inside ? on_side(two_sum(guess.r, step)) : first;
    }

    /// Decides the query if the features are farther apart up to time `from`. `before`: the shortest difference at that
    /// time.
    CRUMPLE_HD FilteredImpact contact_after(const Shortest& before, double from, const SquaredLimit& limit) const {
        // Newton's method: the next time is when the points that are closest now would be at the distance.
        constexpr int most_steps = 8;
        Shortest there = before;
        DoubleWord crossing = word(from);
        for (int step = 0; step < most_steps; ++step) {
            const double last = crossing.high;
            crossing = down_at_limit(there, limit);
            if (!(crossing.high >= from)) return {};
            if (crossing.high >= 1) crossing = word(1);
            if (crossing.high == last) break;
            there = shortest(crossing.high);
        }
        if (crossing.high == 1 && farther_between(before, from, there, 1, limit)) return {Certainty::apart};
        if (!(crossing.high > 0x1p-100)) return {};
        const double toi = crossing.low < 0 ? std::nextafter(crossing.high, 0.0) : crossing.high;
        if (toi < crossing.high) there = shortest(toi);  // recomputed at exactly `toi`, as the direction may turn fast
        const bool certain = toi >= from && toi < 1 && farther_between(before, from, there, toi, limit) &&
                             closer(there, std::nextafter(toi, 1.0), limit);
        return certain ? FilteredImpact{Certainty::meets, toi} : FilteredImpact{};
    }

    /// Returns a time after `from` up to which the features are still farther apart, or `from` itself.
    CRUMPLE_HD double far_past(const Shortest& before, double from, const SquaredLimit& limit) const {
        double step = 0x1p-8;
        for (int attempt = 0; attempt < 7; ++attempt, step *= 0x1p-6) {
            const double to = min(1., from + step);
            if (farther_between(before, from, shortest(to), to, limit)) return to;
        }
        return from;
    }

    /// Computes the limit. Returns false if it is out of range, or if it is a share of the distance at the start and
    /// this distance is not known accurately enough.
    CRUMPLE_HD bool squared_limit(const MinDistance& separation, const Shortest& at_start, SquaredLimit& limit) const {
        const TwoTerms distance = two_product(separation.distance, separation.distance);
        limit = {distance, distance};
        if (separation.share > 0) {
            const TwoTerms share = two_product(separation.share, separation.share);
            const DoubleWord squared = dot_product(at_start.g, at_start.g);
            const DoubleWord height = least(corner_heights(start_, at_start.g)) - word(height_error(at_start.g));
            if (!(squared.high > 0x1p-200 && height.high > 0)) return false;
            const DoubleWord above = squared + word(length_error(at_start.g, squared.high));
            const DoubleWord below = height * height / squared;
            const double slack = 8 * word_error;
            const DoubleWord high = share * above * two_sum(1, slack), low = share * below * two_sum(1, -slack);
            if ((high - limit.high).high > 0) limit.high = high;
            if ((low - limit.low).high > 0) limit.low = low;
        }
        return limit.low.high >= 0x1p-200 && limit.high.high <= 0x1p200;
    }

    /// Returns a bound on how far g · g is from the squared length of the difference that exact arithmetic has at some
    /// point of the domain.
    CRUMPLE_HD double length_error(const Vec3dw& g, double squared) const {
        const double off = word_error * rounded_difference_.size;
        return off * (4 * length_1(high(g)) + 4 * off) + word_error * squared;
    }

    CRUMPLE_HD double height_error(const Vec3dw& g) const {
        return word_error * length_1(high(g)) * rounded_difference_.size;
    }

    CRUMPLE_HD static std::array<DoubleWord, 4> corner_heights(const Difference<DoubleWord>& x, const Vec3dw& g) {
        const DoubleWord w = dot_product(g, x.w), u = dot_product(g, x.u), v = dot_product(g, x.v);
        return {w, w + u, w + v, (w + u) + v};
    }

    CRUMPLE_HD static DoubleWord least(const std::array<DoubleWord, 4>& height) {
        DoubleWord result = height[0];
        for (std::size_t i = 1; i < corners<kinds>; ++i) {
            if ((height[i] - result).high < 0) result = height[i];
        }
        return result;
    }

    /// Returns an upper bound on the minimum distance times the length of g.
    CRUMPLE_HD static DoubleWord limit_along(const Vec3dw& g, const SquaredLimit& limit) {
        const DoubleWord squared = limit.high * dot_product(g, g);
        const double root = std::sqrt(squared.high);
        return (word(root) + (squared - two_product(root, root)) / word(2 * root)) * two_sum(1, 4 * word_error);
    }

    /// True if the features are certainly farther apart from time `from` to time `to`, along a direction that turns
    /// from that of `first` to that of `second`.
    CRUMPLE_HD bool farther_between(const Shortest& first, double from, const Shortest& second, double to,
                                    const SquaredLimit& limit) const {
        const Vec3dw f = first.direction(), g = second.direction();
        if (!(length_1(high(f)) > 0.5 && length_1(high(g)) > 0.5)) return false;
        // Along a direction that changes linearly from f to g, heights are quadratic in time, with the Bernstein
        // coefficients f_x, middle / 2 and g_y. The minimum distance times the length of the direction is convex, so it
        // is at most the line from f_limit to g_limit.
        const Difference<DoubleWord> x = at(from), y = at(to);
        const auto f_x = corner_heights(x, f), f_y = corner_heights(y, f), g_x = corner_heights(x, g),
                   g_y = corner_heights(y, g);
        std::array<DoubleWord, 4> middle{};
        for (std::size_t i = 0; i < corners<kinds>; ++i) middle[i] = f_y[i] + g_x[i];
        const DoubleWord f_limit = limit_along(f, limit), g_limit = limit_along(g, limit);
        const double error = height_error(f) + height_error(g);
        const auto above = [&](DoubleWord height, DoubleWord bound) {
            return (height - bound).high > error + 4 * word_error * bound.high;
        };
        return above(least(f_x), f_limit) && above(least(g_y), g_limit) && above(least(middle), f_limit + g_limit);
    }

    /// True if the difference at these parameters is certainly shorter than the limit at `time`.
    CRUMPLE_HD bool closer(const Shortest& shortest, double time, const SquaredLimit& limit) const {
        const Vec3dw g = combine(at(time), shortest.s, shortest.t);
        const DoubleWord squared = dot_product(g, g), above = squared + word(length_error(g, squared.high));
        return (limit.low - above).high > 4 * word_error * limit.low.high;
    }

    /// Returns the approximate time at which the difference at these parameters, measured along its own direction,
    /// falls to the limit; at least 1 if it never does.
    CRUMPLE_HD DoubleWord down_at_limit(const Shortest& at, const SquaredLimit& limit) const {
        const Vec3dw g = at.direction();
        const DoubleWord start = dot_product(g, combine(start_, at.s, at.t)),
                         end = dot_product(g, combine(end_, at.s, at.t));
        const DoubleWord fall = start - end;
        return fall.high > 0 ? (start - limit_along(g, limit)) / fall : word(1);
    }

    const MovingDifference<kinds>& rounded_difference_;
    Difference<DoubleWord> start_, end_;
};

}  // namespace crumple::detail
