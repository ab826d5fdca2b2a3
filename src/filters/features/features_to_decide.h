#pragma once

// Pair of features with all the input of its exact decision, as a device passes it to the host. Compiled for host and
// device.

#include "filters/features/feature_points.h"

namespace crumple {

/// Returns the limit on the distance of a pair of features, as a sum of two terms: for each feature the largest radius
/// of its vertices or, if `radii` is null, `distance` and 0.
CRUMPLE_HD inline DistanceLimit distance_limit_of(FeatureKind kind, const std::int32_t (&vertex)[4],
                                                  const double* radii, double distance, bool strict) {
    if (!radii) return {distance, 0, strict};
    const double r[4] = {radii[vertex[0]], radii[vertex[1]], radii[vertex[2]], radii[vertex[3]]};
    const double last = max(r[2], r[3]);
    return kind == FeatureKind::edge_edge ? DistanceLimit{max(r[0], r[1]), last, strict}
                                          : DistanceLimit{r[0], max(r[1], last), strict};
}

/// Pair of features that a device could not decide.
struct FeaturesToDecide {
    FeatureKind kind;
    Pair pair;
    FeaturePoints points;
    DistanceLimit reach;  ///< limit that a proximity is compared with
    bool has_rest;
    std::array<Vec3d, 4> rest;  ///< positions of the four points in the rest shape, if has_rest
};

}  // namespace crumple
