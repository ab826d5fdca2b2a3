#pragma once

// Part of the backend interface: feature queries on meshes in device memory. Only the cuda backend implements it.
//
// The host derives edges, and the triangle that owns each feature, from a copy of the mesh's triangles and
// codimensional edges and points (MeshView::edges, MeshView::points). A request refers to the features of the last
// copy, whose counts must match the mesh. If a call finds that the contents of the mesh differ from that copy, it
// reports this, and the caller repeats the call with new features.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "backends/device_shape.h"
#include "queries/device_result.h"
#include "queries/feature_request.h"

namespace crumple {

/// Number of a launch of a detector, counted over all queries: 1, 2, ... A refused launch has none.
using LaunchNumber = std::uint64_t;

/// Maximum number of launches in flight. Their numbers are consecutive, so they differ modulo this.
inline constexpr std::size_t most_in_flight = 2;

/// Throws the Error for a launch in a capture without the calls that have to precede it. `of_worlds`: false for meshes.
[[noreturn]] void fail_unprepared_capture(bool of_worlds);

class DeviceFeatureCalls {
   public:
    virtual ~DeviceFeatureCalls() = default;

    /// Copies a mesh to the host. Waits for the mesh's stream.
    virtual void copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) = 0;

    /// Finds the result and copies it to the host. Returns false if the mesh has other features than the request.
    virtual bool find(const DeviceShape& mesh, const FeatureRequest& request, FeatureResult& result) = 0;

    /// Returns true if the mesh's stream is being captured, so that it must not be waited for.
    virtual bool is_captured(const DeviceShape& mesh) = 0;

    /// Implements Detector::launch for feature queries.
    virtual LaunchNumber launch(const DeviceShape& mesh, const FeatureRequest& request) = 0;
    /// Waits for a launch or, if it was captured in a graph, reads the result of the graph's last replay. Returns
    /// nothing if find_again() has to find the result.
    virtual std::optional<AnyDeviceResult> wait(LaunchNumber launch) = 0;
    /// Finds the result of a launch for which wait() has returned nothing. Returns nothing if the mesh has other
    /// features than the request.
    virtual std::optional<AnyDeviceResult> find_again(LaunchNumber launch, const DeviceShape& mesh,
                                                      const FeatureRequest& request) = 0;
};

}  // namespace crumple
