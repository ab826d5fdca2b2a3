#pragma once

// Calls about features: of scenes on the host, and of meshes on the device, whose answers go to the host or stay there.

#include <optional>

#include "backends/cuda/candidates/candidate_finder.h"
#include "backends/cuda/device/turns.h"
#include "backends/cuda/features/feature_finder.h"
#include "backends/device_feature_calls.h"

namespace crumple::cuda {

class FeatureCalls final : public DeviceFeatureCalls {
   public:
    FeatureCalls(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                 MemoryMeter& meter, Cancellation& cancellation, Turns& turns,
                 const std::array<Input*, Flights::slots>& inputs);

    void find(const PreparedScene& scene, const FeatureRequest& query, FeatureAnswer& answer);
    void find(const PreparedScene& scene, const CandidateRequest& query, CandidateAnswer& answer);

    void copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) override;
    bool find(const DeviceShape& mesh, const FeatureRequest& query, FeatureAnswer& answer) override;
    bool find(const DeviceShape& mesh, const CandidateRequest& query, CandidateAnswer& answer) override;
    bool is_captured(const DeviceShape& mesh) override;
    std::size_t launch(const DeviceShape& mesh, const FeatureRequest& query) override;
    std::size_t launch(const DeviceShape& mesh, const CandidateRequest& query) override;
    Landed wait(Asked question) override;
    std::optional<DeviceAnswer> find_again(std::size_t slot, const DeviceShape& mesh,
                                           const FeatureRequest& query) override;
    std::optional<DeviceAnswer> find_again(std::size_t slot, const DeviceShape& mesh,
                                           const CandidateRequest& query) override;

    /// Gives back all that is kept between calls.
    void release();

   private:
    /// Work begins after what the caller's stream was given.
    void follow(const DeviceShape& mesh);
    template <class Finder, class Query, class Answer>
    void find_of_scene(Finder& finder, const PreparedScene& scene, const Query& query, Answer& answer);
    template <class Finder, class Query, class Answer>
    bool find_of_mesh(Finder& finder, const DeviceShape& mesh, const Query& query, Answer& answer);
    template <class Finder, class Query>
    std::size_t launch_with(Finder& finder, Asked question, const DeviceShape& mesh, const Query& query);
    template <class Finder>
    Landed wait_with(Finder& finder, Asked question);
    template <class Finder, class Query>
    std::optional<DeviceAnswer> again_with(Finder& finder, Asked question, std::size_t slot, const DeviceShape& mesh,
                                           const Query& query);

    const Device& device_;
    cudaStream_t stream_;
    Turns& turns_;
    Event before_;
    FeaturesOnDevice features_there_;
    FeatureFinder features_;
    CandidateFinder candidates_;
};

}  // namespace crumple::cuda
