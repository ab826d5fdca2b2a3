#pragma once

// Calls about features: of scenes on the host, and of meshes on the device, whose results go to the host or stay there.

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
    std::optional<DeviceAnswer> wait(LaunchNumber launch) override;
    std::optional<DeviceAnswer> find_again(LaunchNumber launch, const DeviceShape& mesh,
                                           const FeatureRequest& request) override;

    /// Gives back all that is kept between calls.
    void release();

   private:
    RowFinder& finder_for(const FeatureRequest& request);
    void find_all(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result);
    bool find_in_slot(RowFinder& finder, const DeviceShape& mesh, const FeatureRequest& request);

    BackendState& state_;
    Launches& launches_;
    FeaturesOnDevice features_there_;
    FeatureFinder features_;
    CandidateFinder candidates_;
    std::array<RowFinder*, most_in_flight> launched_{};  ///< by number of a launch
};

}  // namespace crumple::cuda
