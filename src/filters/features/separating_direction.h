#pragma once

// Filter of pairs of triangles that are further apart than a distance, static or during a whole step, because one of a
// few directions separates them (docs/features.md). Projections on a fixed direction are linear in time, so a direction
// that separates two triangles at the start and at the end, on the same side, separates them at all times. Compiled for
// host and device.

#include "filters/features/feature_record.h"
#include "filters/features/length.h"

namespace crumple {

/// Error of two compared projections together, relative to the largest |coordinate| of a corner in the leaf, the set of
/// triangles that one sweep searches (docs/features.md).
inline constexpr float projection_error = 20 * unit_roundoff;

/// Returns an upper bound, except for errors of coordinates, on the distance at the start of the two features of each
/// test of the pair (tests_of_pair.h). A vertex is no farther from a face than from its corners, and an edge no farther
/// from an edge than their ends are from each other.
template <int moments>
CRUMPLE_HD float most_at_start(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b) {
    float square[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Vec3f way = b.at(j) - a.at(i);
            square[i][j] = dot(way, way);
        }
    float most = 0;
    for (int i = 0; i < 3; ++i) {
        most = max(most, min(square[i][0], min(square[i][1], square[i][2])));
        most = max(most, min(square[0][i], min(square[1][i], square[2][i])));
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, j1 = (j + 1) % 3;
            most = max(most, min(min(square[i][j], square[i][j1]), min(square[i1][j], square[i1][j1])));
        }
    }
    return std::sqrt(most + least_square);
}

/// Bound that the gap between two triangles along a direction of length 1 must exceed to prove that their features are
/// further apart than requested. For other directions, the bound is multiplied by their length(), because errors of
/// projections grow with the length, too; underflow errors are below 1e-18 times the least value of length().
struct NeededGap {
    float gap, error;  ///< gap: bound for the requested distance; error: the part of it that covers errors
    float share;       ///< requested share of a pair's distance at the start; the larger bound applies

    /// `distance`: the requested distance in normalised coordinates; `reach`: the largest |coordinate| of a corner in
    /// the leaf; `share`: see share_to_filter().
    CRUMPLE_HD NeededGap(float distance, float reach, float share = 0)
        : error(projection_error * reach + 1e-18f), share(share) {
        gap = distance * 1.000002f + error;
    }
    /// Returns the bound for a pair.
    template <int moments>
    CRUMPLE_HD float of(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b) const {
        return share > 0 ? max(gap, share * (most_at_start(a, b) * 1.000002f + 2 * error) + error) : gap;
    }
};

/// Returns true if d separates a from b by more than `gap` at each time sample, on the same side.
template <int moments>
CRUMPLE_HD bool separates(const Vec3f& d, const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, float gap) {
    bool above = true, below = true;
    for (int m = 0; m < moments; ++m) {
        float low_a = dot(d, a.at(4 * m)), high_a = low_a, low_b = dot(d, b.at(4 * m)), high_b = low_b;
        for (int k = 1; k < 3; ++k) {
            const float value_a = dot(d, a.at(4 * m + k)), value_b = dot(d, b.at(4 * m + k));
            low_a = min(low_a, value_a), high_a = max(high_a, value_a);
            low_b = min(low_b, value_b), high_b = max(high_b, value_b);
        }
        above = above && low_b - high_a > gap;
        below = below && low_a - high_b > gap;
    }
    return above || below;
}

/// Returns the sum of all corners of b, at all time samples, minus that of a: the vector between their centroids, times
/// the number of corners that each has.
template <int moments>
CRUMPLE_HD Vec3f between_centroids(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b) {
    Vec3f between = {0, 0, 0};
    for (int i = 0; i < 4 * moments; i += 4)
        between = between + ((b.at(i) + b.at(i + 1) + b.at(i + 2)) - (a.at(i) + a.at(i + 1) + a.at(i + 2)));
    return between;
}

/// Corners of a and b at their common vertex, if they have exactly one; else -1.
struct CommonCorner {
    int of_a = -1, of_b = -1;

    template <int moments>
    CRUMPLE_HD CommonCorner(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b) {
        int count = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (a.vertex[i] == b.vertex[j]) of_a = i, of_b = j, ++count;
        if (count != 1) of_a = of_b = -1;
    }
    CRUMPLE_HD explicit operator bool() const { return of_a >= 0; }
};

/// Returns true if, at each time sample, all of b but the common corner lies above that corner along d by more than
/// `gap`, and all of a but that corner below it; or the other way round.
template <int moments>
CRUMPLE_HD bool separates_beside(const CommonCorner& common, const Vec3f& d, const FeatureRecord<moments>& a,
                                 const FeatureRecord<moments>& b, float gap) {
    bool above = true, below = true;
    for (int m = 0; m < moments; ++m) {
        const float place = dot(d, a.corner(m, common.of_a));
        for (int k = 1; k < 3; ++k) {
            const float value_a = dot(d, a.corner(m, (common.of_a + k) % 3));
            const float value_b = dot(d, b.corner(m, (common.of_b + k) % 3));
            above = above && value_b - place > gap && place - value_a > gap;
            below = below && place - value_b > gap && value_a - place > gap;
        }
    }
    return above || below;
}

/// Returns true if each feature of a is further than the requested distance from each feature of b that has no common
/// vertex with it. `gap`: NeededGap::of() for the pair. Tries the direction between the centroids of all corners and,
/// for triangles without a single common corner, the normals of both at each time sample.
template <int moments>
CRUMPLE_HD bool surely_apart(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, float gap) {
    const Vec3f between = between_centroids(a, b);
    const float gap_between = gap * length(between);
    if (const CommonCorner common(a, b); common) return separates_beside(common, between, a, b, gap_between);
    if (separates(between, a, b, gap_between)) return true;
    for (int i = 3; i < 4 * moments; i += 4)
        if (separates(a.at(i), a, b, gap) || separates(b.at(i), a, b, gap)) return true;
    return false;
}

}  // namespace crumple
