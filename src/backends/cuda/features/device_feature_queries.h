#pragma once

// Calls about features: of scenes on the host, and of meshes on the device, whose answers go to the host or stay there.

#include <optional>

#include "backends/cuda/candidates/candidate_finder.h"
#include "backends/cuda/engine/launches.h"
#include "backends/cuda/features/feature_finder.h"
#include "backends/device_feature_calls.h"

namespace crumple::cuda {

class FeatureCalls final : public DeviceFeatureCalls {
   public:
    FeatureCalls(BackendState& state, Launches& launches);

    void find(const PreparedScene& scene, const FeatureRequest& query, FeatureAnswer& answer);
    void find(const PreparedScene& scene, const CandidateRequest& query, CandidateAnswer& answer);

    void copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) override;
    bool find(const DeviceShape& mesh, const FeatureRequest& query, FeatureAnswer& answer) override;
    bool find(const DeviceShape& mesh, const CandidateRequest& query, CandidateAnswer& answer) override;
    bool is_captured(const DeviceShape& mesh) override;
    LaunchNumber launch(const DeviceShape& mesh, const FeatureRequest& query) override;
    LaunchNumber launch(const DeviceShape& mesh, const CandidateRequest& query) override;
    std::optional<DeviceAnswer> wait(LaunchNumber launch, bool of_candidates) override;
    std::optional<DeviceAnswer> find_again(LaunchNumber launch, const DeviceShape& mesh,
                                           const FeatureRequest& query) override;
    std::optional<DeviceAnswer> find_again(LaunchNumber launch, const DeviceShape& mesh,
                                           const CandidateRequest& query) override;

    /// Gives back all that is kept between calls.
    void release();

   private:
    template <class QueryFinder, class Query, class Answer>
    void find_of_scene(QueryFinder& finder, const PreparedScene& scene, const Query& query, Answer& answer);
    template <class QueryFinder, class Query>
    bool find_in_slot(QueryFinder& finder, const DeviceShape& mesh, const Query& query);
    template <class QueryFinder, class Query, class Answer>
    bool find_of_mesh(QueryFinder& finder, const DeviceShape& mesh, const Query& query, Answer& answer);
    template <class QueryFinder, class Query>
    LaunchNumber launch_with(QueryFinder& finder, const DeviceShape& mesh, const Query& query);
    template <class QueryFinder>
    std::optional<DeviceAnswer> wait_with(QueryFinder& finder, LaunchNumber launch);
    template <class QueryFinder, class Query>
    std::optional<DeviceAnswer> again_with(QueryFinder& finder, LaunchNumber launch, const DeviceShape& mesh,
                                           const Query& query);

    BackendState& state_;
    Launches& launches_;
    FeaturesOnDevice features_there_;
    FeatureFinder features_;
    CandidateFinder candidates_;
};

}  // namespace crumple::cuda
