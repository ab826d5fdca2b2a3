#pragma once

// Float64 filter: decides if features that start within the minimum distance come closer than at the start, in float64
// with proven bounds; the result is `unknown` if the bounds do not decide. All other results are those of
// exact_min_distance.h with MinDistance::approaching_only. The derivation is in docs/separation_filters.md. Host only.
//
// Cost: 30 ns.

#include "exact/impact/filtered_impact.h"
#include "exact/impact/surely_farther.h"

namespace crumple {

/// Decides features that start within the minimum distance.
template <FeatureKinds kinds>
FilteredImpact filtered_closing(const std::array<MovingPoint, 4>& points) {
    bool moves = false;
    for (std::size_t i = 0; i < points_of(kinds); ++i) moves = moves || points[i].start != points[i].end;
    if (!moves) return {Certainty::apart};

    const detail::MovingDifference<kinds> x(points);
    if (!x.in_range()) return {};
    const Vec3d g = at(x.start, detail::closest<kinds>(x.start));
    const double squared = dot(g, g);
    if (!(squared > 0x1p-600)) return {};

    // Heights of the domain's corners along g (surely_farther.h), and a bound on their error.
    const std::array<double, 4> start = detail::heights<kinds>(x.start, g), end = detail::heights<kinds>(x.end, g);
    const double error = 16 * 0x1p-53 * largest(abs(g)) * x.size + 0x1p-1022;
    double lowest = start[0];
    for (std::size_t i = 1; i < detail::corners<kinds>; ++i) lowest = min(lowest, start[i]);
    if (!(lowest > error)) return {};

    // The length of the exact shortest difference n is in [least, most], and g differs from n by at most `off`.
    const double slack = 1 + 0x1p-40, place = 16 * 0x1p-53 * x.size + 0x1p-500;
    const double most = (std::sqrt(squared) + place) * slack, least = (lowest - error) / (std::sqrt(squared) * slack);
    const double off = place + std::sqrt(max(0., most * most * slack - least * least)) * slack;
    // Along n, the heights of corners start at n . n or above; each corner moves by at most x.size.
    const double bound = (off * x.size + 2 * error) * slack, top = most * most * slack + bound;
    bool parts = true, closes = true;
    for (std::size_t i = 0; i < detail::corners<kinds>; ++i) {
        const double rise = end[i] - start[i];
        parts = parts && (rise > bound || end[i] > top);
        closes = closes && (rise < -bound || start[i] > top);
    }
    if (parts) return {Certainty::apart};
    return closes ? FilteredImpact{Certainty::meets, 0, true} : FilteredImpact{};
}

}  // namespace crumple
