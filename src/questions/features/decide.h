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

FeatureDecision decide(FeatureKind kind, const FeaturePoints& points, const FeatureQuery& query, FeatureCounts& counts);

}  // namespace crumple
