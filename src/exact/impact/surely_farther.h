#pragma once

// Computes how long two moving features certainly stay farther apart than a distance, in float64 with a proven bound
// (docs/separation_filters.md). Accepts any coordinates; where nothing is proven, nothing is claimed. Compiled for host
// and device.
//
// The height of a difference is its projection on a direction. A direction proves that the features are farther apart
// as long as the heights of all corners of the domain (moving_difference.h) exceed the distance: each corner's height
// is linear in time, so if it exceeds the distance at two times, it does so in between. When the least height falls to
// the distance, the direction of the shortest difference at that time is used next. These times converge to a contact
// as in Newton's method, and never pass it.

#include <cmath>

#include "exact/impact/moving_difference.h"

namespace crumple {
namespace detail {

/// Differences at the start and at the end, each component off by one rounding.
template <FeatureKinds kinds>
struct MovingDifference {
    Difference<double> start, end;
    double size = 0;  ///< the sum of all magnitudes

    CRUMPLE_HD explicit MovingDifference(const std::array<MovingPoint, 4>& points) {
        const auto& [p, q, r, s] = points;
        const auto subtract = [](const Vec3d& x, const Vec3d& y) { return x - y; };
        start = difference<kinds>(p.start, q.start, r.start, s.start, subtract);
        end = difference<kinds>(p.end, q.end, r.end, s.end, subtract);
        const Vec3d sum = abs(start.w) + abs(start.u) + abs(start.v) + abs(end.w) + abs(end.u) + abs(end.v);
        size = sum.x + sum.y + sum.z;
    }

    CRUMPLE_HD bool in_range() const { return size < 0x1p300; }

    /// Returns the difference at time t, approximately.
    CRUMPLE_HD Difference<double> at(double t) const {
        const auto mix = [&](const Vec3d& from, const Vec3d& to) { return (1 - t) * from + t * to; };
        return {mix(start.w, end.w), mix(start.u, end.u), mix(start.v, end.v)};
    }
};

/// Time up to which, from the start on, the features are certainly farther apart than the distance; there is none if
/// `any` is false.
struct FarTime {
    bool any = false;
    double until = 0;
};

/// Returns the heights of the domain's corners along a direction.
template <FeatureKinds kinds>
CRUMPLE_HD inline std::array<double, 4> heights(const Difference<double>& x, const Vec3d& direction) {
    const double w = dot(direction, x.w), u = dot(direction, x.u), v = dot(direction, x.v);
    return {w, w + u, w + v, w + u + v};
}

/// Returns the last time after `from` up to which one direction proves that the features are farther apart than
/// `distance`. If the direction proves this at `from` only, returns `from`; if not even there, `any` is false.
template <FeatureKinds kinds>
CRUMPLE_HD inline FarTime far_along(const MovingDifference<kinds>& x, const Vec3d& direction, double distance,
                                    double from) {
    const double squared = dot(direction, direction);
    if (!(squared > 0x1p-900)) return {false, from};
    const double error = 16 * 0x1p-53 * largest(abs(direction)) * x.size + 0x1p-1022;
    const double bound = distance * std::sqrt(squared) * (1 + 8 * 0x1p-53) + error;
    const std::array<double, 4> start = heights<kinds>(x.start, direction), end = heights<kinds>(x.end, direction);
    const auto above = [&](double t) {
        bool all = true;
        for (std::size_t i = 0; i < corners<kinds>; ++i) all = all && (1 - t) * start[i] + t * end[i] > bound;
        return all;
    };
    if (!above(from)) return {false, from};
    double until = 1;
    for (std::size_t i = 0; i < corners<kinds>; ++i) {
        // Slightly before the height reaches the bound, so that it is still above after rounding.
        const double fall = start[i] - end[i];
        if (!(end[i] > bound)) until = min(until, (start[i] - (bound + error)) / fall);
    }
    return {true, until > from && above(until) ? until : from};
}

/// Extends `far` until its time exceeds `enough`, reaches 1, or no longer advances.
template <FeatureKinds kinds>
CRUMPLE_HD inline FarTime far_time(const MovingDifference<kinds>& x, double distance, FarTime far = {},
                                   double enough = 1) {
    constexpr int most_steps = 24;
    for (int step = 0; step < most_steps && far.until < 1 && !(far.until > enough); ++step) {
        const Difference<double> now = x.at(far.until);
        const FarTime next = far_along(x, at(now, closest<kinds>(now)), distance, far.until);
        if (!next.any) break;
        const bool stalls = next.until - far.until < 0x1p-46;
        far = next;
        if (stalls) break;
    }
    return far;
}

}  // namespace detail

/// True if the features are certainly farther apart than `distance` at all times.
template <FeatureKinds kinds>
CRUMPLE_HD inline bool surely_farther(const std::array<MovingPoint, 4>& points, double distance) {
    const detail::MovingDifference<kinds> x(points);
    const detail::FarTime far = x.in_range() ? detail::far_time(x, distance) : detail::FarTime{};
    return far.any && far.until == 1;
}

}  // namespace crumple
