#pragma once

// The part of the seam that is about features of meshes in device memory. Only the cuda backend has it.
//
// What edges there are, and which triangle owns what, the host makes of the mesh's triangles, and of edges and points
// that are listed. A query brings the features of the mesh as it was when it was seen last, with counts that fit; a
// call that meets other contents says so, and is made again with new ones.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "backends/device_shape.h"
#include "queries/device_answer.h"
#include "queries/feature_request.h"

namespace crumple {

/// Number of a launch of a detector, of any query: 1, 2, ... What was refused has none.
using LaunchNumber = std::uint64_t;

/// Launches that may be in flight. Their numbers are consecutive, so they differ modulo this.
inline constexpr std::size_t most_in_flight = 2;

/// Throws Error: a launch in a capture finds nothing that earlier ones have made, `of_worlds` or of meshes.
[[noreturn]] void fail_unprepared_capture(bool of_worlds);

class DeviceFeatureCalls {
   public:
    virtual ~DeviceFeatureCalls() = default;

    /// Waits for the stream of the mesh.
    virtual void copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) = 0;

    /// Leaves the result on the host; false where the features are others.
    virtual bool find(const DeviceShape& mesh, const FeatureRequest& request, FeatureResult& result) = 0;

    /// Whether the mesh's stream is being captured, so that nobody may wait for it.
    virtual bool is_captured(const DeviceShape& mesh) = 0;

    /// Detector::launch for queries about features.
    virtual LaunchNumber launch(const DeviceShape& mesh, const FeatureRequest& request) = 0;
    /// Waits for a launch, or looks at what its last replay has left. Returns nothing if the result has to be found
    /// again.
    virtual std::optional<DeviceAnswer> wait(LaunchNumber launch) = 0;
    /// Finds the result of that launch again; nothing where the features are others.
    virtual std::optional<DeviceAnswer> find_again(LaunchNumber launch, const DeviceShape& mesh,
                                                   const FeatureRequest& request) = 0;
};

}  // namespace crumple
