#include "exact/distance/decide_nearest.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace crumple {
namespace {

// Returns one bit for each pair of features, set if the pair is not certainly farther apart than `upper`.
std::uint16_t features_within(const NearestCandidate& candidate, double upper) {
    std::uint32_t within = 0;
    for (std::size_t k = 0; k < triangle_features; ++k) {
        const detail::Differences d(features_of_triangles(candidate.a, candidate.b, k));
        const detail::Guess guess = detail::guess_closest(d);
        if (!d.beyond(d.w + guess.s * d.u + guess.t * d.v, upper)) within |= 1U << k;
    }
    return static_cast<std::uint16_t>(within);
}

LeastDistance told(const RationalNearest& nearest, const Pair& triangles, double radius) {
    return {nearest.squared(), !std::isfinite(radius) || nearest.within(radius), triangles, nearest.points()};
}

LeastDistance told(const ClosestParts& parts, const Pair& triangles, double radius) {
    const Features features = parts.features();
    DistanceCounts counts;
    Distance distance(features, counts);
    LeastDistance least{distance.squared(), !std::isfinite(radius) || distance.within({radius, 0}), triangles, {}};
    least.points = closest_points(features, RationalDistance(features));
    if (parts.second_comes_first()) std::swap(least.points[0], least.points[1]);
    return least;
}

}  // namespace

LeastDistance decide_nearest(Array<NearestCandidate>& candidates, const NearestCandidate& closest, double upper,
                             double radius, std::int64_t& rational) {
    std::sort(candidates.begin(), candidates.end(),
              [](const auto& x, const auto& y) { return x.triangles < y.triangles; });
    const ClosestParts parts(closest.a, closest.b, FilteredNearest(closest.a, closest.b));
    std::optional<Pair> first;  // first pair whose distance is certainly that of the parts
    std::optional<RationalNearest> least;
    Pair least_triangles{};
    const auto compare_with_least = [&](const NearestCandidate& candidate) {
        const std::uint16_t features = features_within(candidate, upper);
        if (features == 0) return;
        RationalNearest nearest(candidate.a, candidate.b, features);
        ++rational;
        if (least && compare(nearest, *least) >= 0) return;
        least = std::move(nearest);
        least_triangles = candidate.triangles;
    };
    const bool by_parts = parts.are_closest_of(closest.a, closest.b);
    for (const NearestCandidate& candidate : candidates) {
        if (candidate.lower > upper) continue;
        if (!by_parts || !parts.are_closest_of(candidate.a, candidate.b))
            compare_with_least(candidate);
        else if (!first)
            first = candidate.triangles;
    }
    if (!least && !first) return {};
    if (!least) return told(parts, *first, radius);
    if (!first) return told(*least, least_triangles, radius);
    const RationalNearest of_parts(closest.a, closest.b, features_within(closest, upper));
    const int order = compare(of_parts, *least);
    if (order > 0 || (order == 0 && least_triangles < *first)) return told(*least, least_triangles, radius);
    return told(parts, *first, radius);
}

}  // namespace crumple
