#pragma once

// Result of a query about features in device memory, as a backend reports it.

#include <array>
#include <cstdint>

#include "crumple/candidates.h"
#include "crumple/device_features.h"
#include "queries/feature_request.h"

namespace crumple {

struct DeviceRows {
    std::int64_t count = 0;
    const Pair* pairs = nullptr;
    const double* value = nullptr;       ///< toi, or squared distance; null for candidates
    const std::uint8_t* flag = nullptr;  ///< start, or touching; null for candidates
};

struct AnyDeviceResult : DeviceFeatures {
    bool any = false;
    FirstImpact first;
    std::array<DeviceRows, candidate_kinds> rows;  ///< by CandidateKind
};

}  // namespace crumple
