#pragma once

// Impacts, proximities and candidates by brute force: all pairs of features, decided in rational arithmetic. Features
// are listed here anew, and no filter but their boxes is used. One thread, O(features²) box tests, some 10 to 40 us for
// each pair of features whose boxes overlap, unless these decide.

#include "base/cancellation.h"
#include "queries/feature_request.h"

namespace crumple {

/// `stream`: takes the rows, instead of the result; or null.
void find_features_by_brute_force(const PreparedScene& scene, const FeatureRequest& query, Cancellation& cancellation,
                                  FeatureResult& result, FeatureStream* stream = nullptr);

}  // namespace crumple
