#pragma once

// Decides when two moving features first come within a minimum distance: by float64 filters, and if these cannot prove
// a result by rational arithmetic. Host only.

#include <array>
#include <cstdint>

#include "exact/impact/impact.h"
#include "exact/impact/min_distance.h"
#include "exact/proximity/static_features.h"

namespace crumple {

/// Number of decisions that took rational arithmetic.
struct MinDistanceCounts {
    std::int64_t rational = 0;
};

/// True if these features certainly have no impact whose rounded time is `time` or before. Cost: 60 ns.
bool surely_later(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const MinDistance& separation,
                  double time);

/// Decides when two features first come within the minimum distance. `points` are in the order of Features. A minimum
/// distance of 0 stands for contact; then all features that touch take rational arithmetic.
Impact decide_min_distance(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const MinDistance& separation,
                           MinDistanceCounts& counts);

}  // namespace crumple
