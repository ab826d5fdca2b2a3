#pragma once

#include <array>
#include <cstdint>

#include "crumple/candidates.h"
#include "crumple/features.h"
#include "crumple/impacts.h"
#include "crumple/intersections.h"

namespace crumple {

// Results about features that lie in device memory (Detector::launch). Lists have the order, and
// the numbers, of those in host memory: what pairs, edges and points are is said there.

/// Impacts of one kind. Null where there are none.
struct DeviceImpactList {
    std::int64_t count = 0;
    const Pair* pairs = nullptr;          ///< count
    const double* toi = nullptr;          ///< count; see ImpactList
    const std::uint8_t* start = nullptr;  ///< count
};

/// Near pairs of one kind.
struct DeviceProximityList {
    std::int64_t count = 0;
    const Pair* pairs = nullptr;               ///< count
    const double* squared_distance = nullptr;  ///< count; see ProximityList
    const std::uint8_t* touching = nullptr;    ///< count
};

/// Candidates of one kind.
struct DeviceCandidateList {
    std::int64_t count = 0;
    const Pair* pairs = nullptr;  ///< count
};

/// What every answer about features on the device says.
struct DeviceFeatures {
    /// False if lists of fixed length were too short for it, or the triangles, edges or points were not those of the
    /// calls before (a launch in a capture): then there is nothing else.
    bool complete = true;
    /// Rows that there are in all lists; where the answer is not complete, those that were found, and there may be
    /// more.
    std::int64_t rows_needed = 0;
    std::int64_t count = 0;       ///< rows of all lists
    const Edge* edges = nullptr;  ///< edge_count: what edges are meant. Valid while the triangles stay the same.
    std::int64_t edge_count = 0;
    Statistics statistics;
};

struct DeviceImpacts : DeviceFeatures {
    bool any = false;   ///< whether anything touches
    FirstImpact first;  ///< from Output::first on
    std::array<DeviceImpactList, feature_kinds> lists;
    const DeviceImpactList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

struct DeviceProximities : DeviceFeatures {
    bool any = false;  ///< whether anything is near
    std::array<DeviceProximityList, feature_kinds> lists;
    const DeviceProximityList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

struct DeviceCandidates : DeviceFeatures {
    std::array<DeviceCandidateList, candidate_kinds> lists;  ///< empty where not asked for
    const DeviceCandidateList& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

}  // namespace crumple
