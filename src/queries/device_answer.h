#pragma once

// An answer about features that lies on the device, as a backend tells of it.

#include <algorithm>
#include <array>
#include <cstdint>

#include "crumple/device_features.h"
#include "queries/candidate_request.h"
#include "queries/feature_request.h"

namespace crumple {

struct DeviceRows {
    std::int64_t count = 0;
    const Pair* pairs = nullptr;
    const double* value = nullptr;       ///< toi, or squared distance; null of candidates
    const std::uint8_t* flag = nullptr;  ///< start, or touching; null of candidates
};

/// About motion and nearness (FeatureKind), or candidates (CandidateKind).
struct DeviceAnswer : DeviceFeatures {
    bool any = false;
    FirstImpact first;
    std::array<DeviceRows, std::max(feature_kinds, candidate_kinds)> rows;  ///< by kind
};

}  // namespace crumple
