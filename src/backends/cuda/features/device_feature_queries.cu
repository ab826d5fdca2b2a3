#include "backends/cuda/features/device_feature_queries.h"

#include "backends/cuda/input/host_shape.h"
#include "crumple/error.h"
#include "results/owned_features.h"

namespace crumple::cuda {

FeatureCalls::FeatureCalls(BackendState& state, Launches& launches)
    : state_(state),
      launches_(launches),
      features_there_(state.stream.get(), state.meter, state.flights),
      features_(state, features_there_),
      candidates_(state, features_there_) {}

void FeatureCalls::release() {
    features_.release();
    candidates_.release();
    features_there_.release();
}

template <class QueryFinder, class Query, class Answer>
void FeatureCalls::find_of_scene(QueryFinder& finder, const PreparedScene& scene, const Query& query, Answer& answer) {
    with_device(state_.device, [&] {
        launches_.finish();
        clear(answer);
        answer.statistics.backend = "cuda";
        if (scene.triangle_count() == 0) return;  // lists have a least size, which no limit need hold for nothing
        finder.bring(finder.current(), scene, query);
        finder.find();
        finder.copy_to(answer);
    });
}
// Of a part all pairs are found, and those that another part owns are left out.
void FeatureCalls::find(const PreparedScene& scene, const FeatureRequest& query, FeatureAnswer& answer) {
    if (!query.part) return find_of_scene(features_, scene, query, answer);
    FeatureRequest all = query;
    all.part = nullptr;
    all.extent = Extent::all;
    find_of_scene(features_, scene, all, answer);
    keep_owned(scene, query, answer);
}
void FeatureCalls::find(const PreparedScene& scene, const CandidateRequest& query, CandidateAnswer& answer) {
    find_of_scene(candidates_, scene, query, answer);
}

bool FeatureCalls::is_captured(const DeviceShape& mesh) {
    return with_device(state_.device, [&] { return capture_of(static_cast<cudaStream_t>(mesh.stream)) != 0; });
}

void FeatureCalls::copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) {
    with_device(state_.device, [&] {
        Places(state_.device.index()).check(mesh.shape);
        state_.follow(mesh.stream, "a mesh's");
        cuda::copy_to_host(mesh.shape, what, state_.stream.get(), host);
    });
}

// Returns false where the features are others.
template <class QueryFinder, class Query>
bool FeatureCalls::find_in_slot(QueryFinder& finder, const DeviceShape& mesh, const Query& query) {
    try {
        state_.follow(mesh.stream, "a mesh's");
        finder.view(finder.current(), mesh.shape, query);
        finder.find();
        return true;
    } catch (const MeshChanged&) {
        return false;
    }
}

template <class QueryFinder, class Query, class Answer>
bool FeatureCalls::find_of_mesh(QueryFinder& finder, const DeviceShape& mesh, const Query& query, Answer& answer) {
    return with_device(state_.device, [&] {
        launches_.finish();
        clear(answer);
        if (!find_in_slot(finder, mesh, query)) return false;
        finder.copy_to(answer);
        return true;
    });
}
bool FeatureCalls::find(const DeviceShape& mesh, const FeatureRequest& query, FeatureAnswer& answer) {
    return find_of_mesh(features_, mesh, query, answer);
}
bool FeatureCalls::find(const DeviceShape& mesh, const CandidateRequest& query, CandidateAnswer& answer) {
    return find_of_mesh(candidates_, mesh, query, answer);
}

template <class QueryFinder, class Query>
LaunchNumber FeatureCalls::launch_with(QueryFinder& finder, const DeviceShape& mesh, const Query& query) {
    const auto stream = static_cast<cudaStream_t>(mesh.stream);
    const auto bind = [&](std::size_t slot, Room room) { finder.view(slot, mesh.shape, query, room); };
    return with_device(state_.device, [&] { return launches_.launch(finder, stream, stream, bind); });
}
LaunchNumber FeatureCalls::launch(const DeviceShape& mesh, const FeatureRequest& query) {
    return launch_with(features_, mesh, query);
}
LaunchNumber FeatureCalls::launch(const DeviceShape& mesh, const CandidateRequest& query) {
    return launch_with(candidates_, mesh, query);
}

template <class QueryFinder>
std::optional<DeviceAnswer> FeatureCalls::wait_with(QueryFinder& finder, LaunchNumber launch) {
    launches_.check_awaited(launch);
    return with_device(state_.device, [&]() -> std::optional<DeviceAnswer> {
        const Launches::Outcome outcome = launches_.wait(finder, features_there_.known().revision);
        if (outcome == Launches::Outcome::lost) return {};
        launches_.mark_reported(launch);
        return outcome == Launches::Outcome::complete ? finder.show() : finder.show_incomplete();
    });
}
std::optional<DeviceAnswer> FeatureCalls::wait(LaunchNumber launch, bool of_candidates) {
    return of_candidates ? wait_with(candidates_, launch) : wait_with(features_, launch);
}

template <class QueryFinder, class Query>
std::optional<DeviceAnswer> FeatureCalls::again_with(QueryFinder& finder, LaunchNumber launch, const DeviceShape& mesh,
                                                     const Query& query) {
    return with_device(state_.device, [&]() -> std::optional<DeviceAnswer> {
        if (!find_in_slot(finder, mesh, query)) return {};
        launches_.mark_reported(launch);
        return finder.show();
    });
}
std::optional<DeviceAnswer> FeatureCalls::find_again(LaunchNumber launch, const DeviceShape& mesh,
                                                     const FeatureRequest& query) {
    return again_with(features_, launch, mesh, query);
}
std::optional<DeviceAnswer> FeatureCalls::find_again(LaunchNumber launch, const DeviceShape& mesh,
                                                     const CandidateRequest& query) {
    return again_with(candidates_, launch, mesh, query);
}

}  // namespace crumple::cuda
