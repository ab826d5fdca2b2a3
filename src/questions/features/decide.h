#pragma once

// Whether two features are an answer, decided exactly: what comes after all filters.

#include <cstdint>

#include "engine/feature_query.h"
#include "questions/features/points.h"

namespace crumple {

struct FeatureDecision {
    bool hit = false;
    double value = 0;   ///< toi, or squared distance
    bool flag = false;  ///< start, or touching
};

/// How pairs were decided.
struct FeatureCounts {
    std::int64_t tests = 0;     ///< all
    std::int64_t rational = 0;  ///< by rational arithmetic
};

/// `vertex`: of the two features, in the order of FeaturePoints.
FeatureDecision decide(FeatureKind kind, const Scene& scene, const std::int32_t (&vertex)[4], const FeatureQuery& query,
                       FeatureCounts& counts);

/// Whether the features are neighbours, though they have no vertex in common.
bool are_neighbours(FeatureKind kind, const std::int32_t (&vertex)[4], const FeatureQuery& query);

}  // namespace crumple
