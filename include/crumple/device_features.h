#pragma once

#include <array>
#include <cstdint>

#include "crumple/candidates.h"
#include "crumple/features.h"
#include "crumple/impacts.h"
#include "crumple/intersections.h"

namespace crumple {

// Results about features in device memory (Detector::launch). Lists have the order and the numbering of the results in
// host memory (Impacts, Proximities, Candidates), where pairs, edges and points are explained. The comment at a pointer
// begins with the length of the array.

/// Impacts of one kind. If there are none, the pointers are null.
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

/// Base of all results about features on the device.
struct DeviceFeatures {
    /// Only after a launch in a capture: false if a list was too short, or if triangles, MeshView::edges or
    /// MeshView::points have changed. Then all lists are empty.
    bool complete = true;
    /// Number of rows of all lists; if the result is incomplete, the number found so far, a lower bound.
    std::int64_t rows_needed = 0;
    std::int64_t count = 0;  ///< number of rows of all lists
    /// edge_count; the edges that indices in pairs refer to. Valid while the triangles stay the same.
    const Edge* edges = nullptr;
    std::int64_t edge_count = 0;
    Statistics statistics;
};

/// Result of an ImpactQuery in device memory.
struct DeviceImpacts : DeviceFeatures {
    bool any = false;   ///< true if anything touches
    FirstImpact first;  ///< for Output::first and Output::pairs
    std::array<DeviceImpactList, feature_kinds> lists;
    const DeviceImpactList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

/// Result of a ProximityQuery in device memory.
struct DeviceProximities : DeviceFeatures {
    bool any = false;  ///< true if anything is near
    std::array<DeviceProximityList, feature_kinds> lists;
    const DeviceProximityList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

/// Result of a CandidateQuery in device memory.
struct DeviceCandidates : DeviceFeatures {
    std::array<DeviceCandidateList, candidate_kinds> lists;  ///< empty if not requested
    const DeviceCandidateList& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

}  // namespace crumple
