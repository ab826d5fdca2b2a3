#pragma once

// When two moving features first come within a distance: float64 where that proves it, else rational arithmetic. Host
// only.

#include <array>
#include <cstdint>

#include "exact/impact/impact.h"
#include "exact/impact/min_distance.h"
#include "exact/proximity/resting_features.h"

namespace crumple {

/// How many queries went how far.
struct SeparationCounts {
    std::int64_t rational = 0;
};

/// True if an impact would certainly have a later time than this, as rounded. Cost: 60 ns.
bool surely_later(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const Separation& separation,
                  double time);

/// The points as in Features: of a vertex and a face, two edges, a vertex and an edge, or two vertices. Without a
/// separation this is an impact, and all that touches takes rational arithmetic.
Impact decide_separation(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const Separation& separation,
                         SeparationCounts& counts);

}  // namespace crumple
