#pragma once

// Roots of the volume of moving features in (0, 1), in ascending order, isolated and enclosed with certainty in
// float64. Compiled for host and device. Proofs are in docs/motion_filters.md.

#include "exact/impact/volume.h"

namespace crumple {

namespace detail {
inline constexpr double underflow = 0x1p-1000;  ///< exceeds the error of a time that is due to underflow
}

/// Open interval with exactly one root, which is simple, and the volume at its ends, whose signs are certain.
struct RootBracket {
    double low, high;
    double at_low, at_high;
};

/// Enclosure of the only root in a bracket: it is within `radius` of `middle`.
struct RootEnclosure {
    double middle, radius;
};

/// Finds the brackets of all roots, in ascending order.
class VolumeRoots {
   public:
    enum class Next { found, none, unknown };

    CRUMPLE_HD explicit VolumeRoots(const Volume& volume) : volume_(volume) {}

    CRUMPLE_HD Next next(RootBracket& root) {
        while (waiting_ > 0) {
            const double low = low_, high = end_[waiting_ - 1];
            const auto c = volume_.coefficients(low, high);
            const int s0 = volume_.sign(c[0]), s1 = volume_.sign(c[1]), s2 = volume_.sign(c[2]),
                      s3 = volume_.sign(c[3]);
            if (s0 == 0 || s3 == 0) return Next::unknown;
            // By Descartes' rule, these conclusions hold whatever the uncertain signs are.
            const bool none = s0 == s3 && s0 == s1 && s0 == s2, one = s0 != s3 && (s0 == s1 || s2 == s3);
            if (none || one) {
                low_ = high;
                --waiting_;
                if (none) continue;
                root = {low, high, c[0], c[3]};
                return Next::found;
            }
            // If the volume first approaches 0 and finally recedes, divide where it comes closest to 0; otherwise in
            // the middle.
            const double d0 = s0 * (c[1] - c[0]), d1 = s0 * (c[2] - c[1]), d2 = s0 * (c[3] - c[2]);
            const double part = d0 < 0 && d2 > 0 ? d0 / (d0 - d1 - std::sqrt(d1 * d1 - d0 * d2)) : 0.5;
            const double middle = lerp(low, high, part);
            if (waiting_ == most || !(middle > low && middle < high)) return Next::unknown;
            end_[waiting_++] = middle;
        }
        return Next::none;
    }

   private:
    static constexpr int most = 12;  // enough unless there is a multiple root
    Volume volume_;
    double low_ = 0;          ///< everything to the left is done
    double end_[most] = {1};  ///< ends of the intervals to the right, the next one last
    int waiting_ = 1;
};

/// Encloses the root of a bracket by Newton's method, with a proven radius. Returns false if float64 proves none.
CRUMPLE_HD inline bool enclose(const Volume& volume, const RootBracket& root, RootEnclosure& place) {
    constexpr int enough = 50;
    double low = root.low, high = root.high;
    double t = lerp(low, high, root.at_low / (root.at_low - root.at_high));
    for (int i = 0; i < enough; ++i) {
        if (!(t > low && t < high)) t = 0.5 * (low + high);
        const Volume::Slope f = volume.slope(t);
        if (volume.sign(f.value) == 0) {
            const double steepness = std::abs(f.derivative);
            place = {t, 4.2 * volume.bound() / steepness + detail::underflow};
            return place.radius <= 0.25 && (f.derivative > 0) == (root.at_high > 0) &&
                   volume.derivative_bound() + volume.bend() * place.radius <= 0.45 * steepness;
        }
        ((f.value > 0) == (root.at_low > 0) ? low : high) = t;
        t -= f.value / f.derivative;
    }
    return false;
}

/// Narrows the enclosure, with the volume in double words (unevaluated sums of two float64 numbers), until it is
/// certain which float64 is the largest not above the root. Returns false if that remains uncertain.
template <FeaturePair pair>
CRUMPLE_HD inline bool round_down(const FourPoints& points, const Approach<pair>& x, const Volume& volume,
                                  RootEnclosure& place, double& rounded) {
    using detail::epsilon, detail::underflow;
    constexpr int enough = 4;
    const double value_bound = precise_volume_bound(x), bend = volume.bend();
    for (int i = 0; i < enough; ++i) {
        const double t = place.middle, derivative = volume.slope(t).derivative, steepness = std::abs(derivative);
        const double derivative_bound = volume.derivative_bound() + bend * place.radius;
        if (!(derivative_bound <= 0.45 * steepness)) return false;
        const double step = -precise_volume<pair>(points, t).high / derivative;
        const double radius = 2.1 * (std::abs(step) * derivative_bound + value_bound) / steepness +
                              16 * epsilon * std::abs(step) + underflow;
        // The root is within `radius` of t + step.
        const TwoTerms low = two_sum(t, step - radius);
        rounded = low.low < 0 ? std::nextafter(low.high, -1.) : low.high;
        const TwoTerms to_next = two_sum(std::nextafter(rounded, 2.), -t);
        place = {t + step, 1.1 * radius + 2 * epsilon * t};
        if (rounded >= 0 && to_next.low == 0 && step + radius < to_next.high) return true;
        if (!(place.middle >= 0 && place.middle <= 1)) return false;
    }
    return false;
}

}  // namespace crumple
