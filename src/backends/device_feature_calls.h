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
#include "queries/candidate_request.h"
#include "queries/device_answer.h"
#include "queries/feature_request.h"

namespace crumple {

/// What a launch asks; each has a wait of its own.
enum class Asked : std::uint8_t { intersections, worlds, impacts, near, candidates };

/// Throws Error: a launch in a capture finds nothing that earlier ones have made.
[[noreturn]] void fail_unprepared_capture(Asked question);

class DeviceFeatureCalls {
   public:
    virtual ~DeviceFeatureCalls() = default;

    /// Waits for the stream of the mesh.
    virtual void copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) = 0;

    /// Answers to the host; false where the features are others.
    virtual bool find(const DeviceShape& mesh, const FeatureRequest& query, FeatureAnswer& answer) = 0;
    virtual bool find(const DeviceShape& mesh, const CandidateRequest& query, CandidateAnswer& answer) = 0;

    /// Whether the mesh's stream is being captured, so that nobody may wait for it.
    virtual bool is_captured(const DeviceShape& mesh) = 0;

    /// Detector::launch for queries about features. Returns the launch's slot, by which wait() names it.
    virtual std::size_t launch(const DeviceShape& mesh, const FeatureRequest& query) = 0;
    virtual std::size_t launch(const DeviceShape& mesh, const CandidateRequest& query) = 0;

    struct Landed {
        std::size_t slot;
        std::optional<DeviceAnswer> answer;  ///< none: it has to be found again
    };
    /// Waits for the oldest launch, which has to ask that; or looks at what a replay has left.
    virtual Landed wait(Asked question) = 0;
    /// Finds the answer of a launch that has landed again; none where the features are others.
    virtual std::optional<DeviceAnswer> find_again(std::size_t slot, const DeviceShape& mesh,
                                                   const FeatureRequest& query) = 0;
    virtual std::optional<DeviceAnswer> find_again(std::size_t slot, const DeviceShape& mesh,
                                                   const CandidateRequest& query) = 0;
};

}  // namespace crumple
