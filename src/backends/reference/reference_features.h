#pragma once

// Motion and nearness by brute force: all pairs of features, decided in rational arithmetic. Features are listed here
// anew, and no filter but their boxes is used. One thread, O(features²) box tests, some 10 to 40 us for each pair of
// features whose boxes overlap.

#include "base/cancellation.h"
#include "queries/feature_request.h"

namespace crumple {

/// Takes a row.
using HitSink = FunctionRef<void(FeatureKind kind, const FeatureHit& hit)>;

/// `sink`: takes each row, instead of the answer; or null.
void find_features_by_brute_force(const PreparedScene& scene, const FeatureRequest& query, Cancellation& cancellation,
                                  FeatureAnswer& answer, const HitSink* sink = nullptr);

}  // namespace crumple
