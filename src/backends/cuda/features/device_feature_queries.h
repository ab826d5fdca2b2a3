#pragma once

// Feature queries: on scenes on the host, and on meshes on the device, whose results are copied to the host or stay on
// the device.

#include <array>
#include <optional>

#include "backends/cuda/candidates/candidate_finder.h"
#include "backends/cuda/engine/launches.h"
#include "backends/cuda/features/feature_finder.h"
#include "backends/device_feature_calls.h"

namespace crumple::cuda {

class FeatureCalls final : public DeviceFeatureCalls {
   public:
    FeatureCalls(BackendState& state, Launches& launches);

    void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result);

    void copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) override;
    bool find(const DeviceShape& mesh, const FeatureRequest& request, FeatureResult& result) override;
    bool is_captured(const DeviceShape& mesh) override;
    LaunchNumber launch(const DeviceShape& mesh, const FeatureRequest& request) override;
    std::optional<AnyDeviceResult> wait(LaunchNumber launch) override;
    std::optional<AnyDeviceResult> find_again(LaunchNumber launch, const DeviceShape& mesh,
                                              const FeatureRequest& request) override;

    /// Frees everything that is cached between calls.
    void release();

   private:
    RowFinder& finder_for(const FeatureRequest& request);
    void find_all(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result);
    bool find_in_slot(RowFinder& finder, const DeviceShape& mesh, const FeatureRequest& request);

    BackendState& state_;
    Launches& launches_;
    FeaturesOnDevice device_features_;
    FeatureFinder features_;
    CandidateFinder candidates_;
    std::array<RowFinder*, most_in_flight> launched_{};  ///< finder of each launch, by its number modulo most_in_flight
};

}  // namespace crumple::cuda
