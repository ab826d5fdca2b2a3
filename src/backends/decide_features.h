#pragma once

// Exact decision of one pair of features, the last step after all filters.

#include <cstdint>
#include <optional>

#include "exact/proximity/guess_batch.h"
#include "filters/features/feature_points.h"
#include "filters/features/features_to_decide.h"
#include "queries/feature_request.h"

namespace crumple {

struct FeatureDecision {
    bool hit = false;
    double value = 0;   ///< time of an impact (Impact::toi), or squared distance of a proximity
    bool flag = false;  ///< an impact happens at the start (Impact::start), or a proximity's distance is 0
};

/// Counts of decisions.
struct FeatureCounts {
    std::int64_t tests = 0;     ///< all decisions
    std::int64_t rational = 0;  ///< decisions that took rational arithmetic
};

/// Decides a pair by the request's criterion. `vertex`: vertices of the two features, in the order of FeaturePoints.
FeatureDecision decide(FeatureKind kind, const PreparedScene& scene, const std::int32_t (&vertex)[4],
                       const FeatureRequest& query, FeatureCounts& counts);

/// Returns true if two features certainly have no impact whose rounded time is `time` or before.
bool surely_later(FeatureKind kind, const PreparedScene& scene, const std::int32_t (&vertex)[4],
                  const FeatureRequest& query, double time);

/// Decides a pair that a device could not decide, from the input that it has passed to the host.
FeatureDecision decide(const FeaturesToDecide& pair, const FeatureRequest& query, FeatureCounts& counts);

/// Decides a proximity, but leaves the distance of a near pair to SIMD lanes: adds the pair to `batch`, which must not
/// be full, and returns nothing. Returns a decision if the pair is not near, or if rational arithmetic was needed to
/// see that it is.
std::optional<FeatureDecision> decide_or_add(FeatureKind kind, const PreparedScene& scene,
                                             const std::int32_t (&vertex)[4], const FeatureRequest& query,
                                             FeatureCounts& counts, cpu::GuessBatch& batch);

/// Returns true if two features without a common vertex are adjacent: a path of at most query.rings->rings() edges
/// joins a vertex of one to a vertex of the other. `query.rings` must not be null.
bool are_adjacent(FeatureKind kind, const std::int32_t (&vertex)[4], const FeatureRequest& query);

}  // namespace crumple
