#pragma once

// Impacts, proximities and candidates by brute force: all pairs of features, decided in rational arithmetic. Features
// are listed independently of other backends, and boxes are the only filter. One thread, O(features²) box tests, and,
// except for candidates, some 10 to 40 us for each pair of features whose boxes overlap.

#include "base/cancellation.h"
#include "queries/feature_request.h"

namespace crumple {

/// Finds all pairs of features that the request lists. `stream`, if not null, receives the rows while they are found;
/// the last ones, fewer than a block, stay in `result`.
void find_features_by_brute_force(const PreparedScene& scene, const FeatureRequest& query, Cancellation& cancellation,
                                  FeatureResult& result, FeatureStream* stream = nullptr);

}  // namespace crumple
