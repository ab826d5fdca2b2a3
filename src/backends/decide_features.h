#pragma once

// Whether two features are an answer, decided exactly: what comes after all filters.

#include <cstdint>
#include <optional>

#include "exact/proximity/guess_batch.h"
#include "filters/features/feature_points.h"
#include "filters/features/packed_features.h"
#include "queries/feature_request.h"

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
FeatureDecision decide(FeatureKind kind, const PreparedScene& scene, const std::int32_t (&vertex)[4],
                       const FeatureRequest& query, FeatureCounts& counts);

/// True if an impact of two features would certainly have a later time than this, as rounded.
bool surely_later(FeatureKind kind, const PreparedScene& scene, const std::int32_t (&vertex)[4],
                  const FeatureRequest& query, double time);

/// The same of a pair that a device has packed.
FeatureDecision decide(const PackedFeatures& pair, const FeatureRequest& query, FeatureCounts& counts);

/// The same where nearness is asked for and lanes can measure distances: if the features are near, but how near is
/// quickly said, they are added to the batch, which has room, and there is no decision yet.
std::optional<FeatureDecision> decide_or_add(FeatureKind kind, const PreparedScene& scene,
                                             const std::int32_t (&vertex)[4], const FeatureRequest& query,
                                             FeatureCounts& counts, cpu::GuessBatch& batch);

/// Whether the features are neighbours, though they have no vertex in common.
bool are_neighbours(FeatureKind kind, const std::int32_t (&vertex)[4], const FeatureRequest& query);

}  // namespace crumple
