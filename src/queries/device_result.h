#pragma once

// Result that a backend returns for a query about features of a mesh in device memory. The rows of each kind and the
// edges stay in device memory, and the result has pointers to them. Counts, `any` and the first impact are on the host.

#include <array>
#include <cstdint>

#include "crumple/candidates.h"
#include "crumple/device_features.h"
#include "queries/feature_request.h"

namespace crumple {

struct DeviceRows {
    std::int64_t count = 0;
    const Pair* pairs = nullptr;
    const double* value = nullptr;       ///< ImpactList::toi or ProximityList::squared_distance; null for candidates
    const std::uint8_t* flag = nullptr;  ///< ImpactList::start or ProximityList::touching; null for candidates
};

struct AnyDeviceResult : DeviceFeatures {
    bool any = false;
    FirstImpact first;
    std::array<DeviceRows, candidate_kinds> rows;  ///< rows of each CandidateKind
};

}  // namespace crumple
