#pragma once

// Which pairs of features are no answer for certain: what is tested between the pair of their triangles and the exact
// decision (docs/features.md). Points are normalised, and exact. Compiled for host and device.

#include "crumple/features.h"
#include "geometry/vec.h"

namespace crumple {

/// How many of the four points belong to the first feature.
CRUMPLE_HD constexpr int first_points(FeatureKind kind) { return kind == FeatureKind::vertex_face ? 1 : 2; }

/// Whether the boxes of both features' ways are further apart than `distance`, along an axis. `p`: four points at the
/// start, then at the end.
template <int moments>
CRUMPLE_HD bool boxes_apart(const Vec3d p[4 * moments], FeatureKind kind, double distance) {
    const int first = first_points(kind);
    Vec3d low[2] = {p[0], p[first]}, high[2] = {p[0], p[first]};
    for (int i = 0; i < 4 * moments; ++i) {
        const int of = i % 4 < first ? 0 : 1;
        low[of] = min(low[of], p[i]);
        high[of] = max(high[of], p[i]);
    }
    // A difference errs by half a unit in the last place, which the factor covers.
    const Vec3d out = max(low[0] - high[1], low[1] - high[0]);
    return largest(out) * (1 - 0x1p-50) > distance;
}

}  // namespace crumple
