#pragma once

// Float64 filter: computes when two moving features first come within a minimum distance, in float64 and double words
// (unevaluated sums of two float64 numbers), with proven bounds; the result is `unknown` if the bounds do not decide.
// All other results are those of exact_min_distance.h, bit for bit. Accepts any coordinates; NaN and infinity give
// `unknown`. Compiled for host and device. The derivation is in docs/separation_filters.md.
//
// Cost: 70 to 200 ns if the features stay apart, 2 to 4 us to compute a time.

#include "exact/impact/double_word_min_distance.h"

namespace crumple {
namespace detail {

/// Returns an upper bound on the distance of the features at the start.
template <FeatureKinds kinds>
CRUMPLE_HD inline double length_at_start(const MovingDifference<kinds>& x) {
    const Vec3d g = at(x.start, closest<kinds>(x.start));
    return (std::sqrt(dot(g, g)) + (16 * 0x1p-53 * x.size + 0x1p-500)) * (1 + 8 * 0x1p-53);
}

/// Returns the requested minimum distance, rounded up: the larger of `distance` and the share of the distance at the
/// start.
template <FeatureKinds kinds>
CRUMPLE_HD inline double distance_of(const MinDistance& separation, const MovingDifference<kinds>& x) {
    if (!(separation.share > 0)) return separation.distance;
    return max(separation.distance, separation.share * length_at_start(x) * (1 + 2 * 0x1p-53));
}

template <FeatureKinds kinds>
CRUMPLE_HD_COLD FilteredImpact double_word_min_distance(const std::array<MovingPoint, 4>& points,
                                                        const MinDistance& separation, const MovingDifference<kinds>& x,
                                                        const FarTime& far, double distance) {
    if (!(x.size < 0x1p100)) return {};
    return DoubleWordMinDistance<kinds>(points, x).decide(separation, far, distance);
}

}  // namespace detail

/// True if these features certainly have no impact whose rounded time is `time` or before.
template <FeatureKinds kinds>
CRUMPLE_HD inline bool surely_later(const std::array<MovingPoint, 4>& points, const MinDistance& separation,
                                    double time) {
    const detail::MovingDifference<kinds> x(points);
    if (!x.in_range()) return false;
    const detail::FarTime far = detail::far_time(x, detail::distance_of(separation, x), {}, time);
    return far.any && far.until > time;
}

template <FeatureKinds kinds>
CRUMPLE_HD inline FilteredImpact filtered_min_distance(const std::array<MovingPoint, 4>& points,
                                                       const MinDistance& separation) {
    const detail::MovingDifference<kinds> x(points);
    if (!x.in_range()) return {};
    const double distance = detail::distance_of(separation, x);
    const detail::FarTime far = detail::far_time(x, distance);
    if (far.any && far.until == 1) return {Certainty::apart};
    if (!far.any && detail::length_at_start(x) <= separation.distance) return {Certainty::meets, 0, true};
    return detail::double_word_min_distance(points, separation, x, far, distance);
}

}  // namespace crumple
