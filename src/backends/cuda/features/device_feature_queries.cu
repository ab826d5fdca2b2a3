#include "backends/cuda/features/device_feature_queries.h"

#include "backends/cuda/input/host_shape.h"
#include "crumple/error.h"
#include "results/owned_features.h"

namespace crumple::cuda {
namespace {

Asked asked(const FeatureRequest& query) { return query.motion ? Asked::impacts : Asked::near; }

}  // namespace

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
bool FeatureCalls::find_in_slot(QueryFinder& finder, std::size_t slot, const DeviceShape& mesh, const Query& query) {
    try {
        state_.follow(mesh.stream, "a mesh's");
        finder.view(slot, mesh.shape, query);
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
        if (!find_in_slot(finder, finder.current(), mesh, query)) return false;
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
std::size_t FeatureCalls::launch_with(QueryFinder& finder, Asked question, const DeviceShape& mesh,
                                      const Query& query) {
    const auto stream = static_cast<cudaStream_t>(mesh.stream);
    with_device(state_.device, [&] {
        launches_.launch(finder, question, stream, stream,
                         [&](std::size_t slot, Room room) { finder.view(slot, mesh.shape, query, room); });
    });
    return finder.current();
}
std::size_t FeatureCalls::launch(const DeviceShape& mesh, const FeatureRequest& query) {
    return launch_with(features_, asked(query), mesh, query);
}
std::size_t FeatureCalls::launch(const DeviceShape& mesh, const CandidateRequest& query) {
    return launch_with(candidates_, Asked::candidates, mesh, query);
}

template <class QueryFinder>
FeatureCalls::Landed FeatureCalls::wait_with(QueryFinder& finder, Asked question) {
    launches_.check_awaited(question);
    return with_device(state_.device, [&]() -> Landed {
        const Launches::Outcome outcome = launches_.wait(finder, question, features_there_.known().revision);
        if (outcome == Launches::Outcome::lost) return {finder.current(), {}};
        launches_.mark_reported(question);
        const bool complete = outcome == Launches::Outcome::complete;
        return {finder.current(), complete ? finder.show() : finder.show_incomplete()};
    });
}
FeatureCalls::Landed FeatureCalls::wait(Asked question) {
    return question == Asked::candidates ? wait_with(candidates_, question) : wait_with(features_, question);
}

template <class QueryFinder, class Query>
std::optional<DeviceAnswer> FeatureCalls::again_with(QueryFinder& finder, Asked question, std::size_t slot,
                                                     const DeviceShape& mesh, const Query& query) {
    return with_device(state_.device, [&]() -> std::optional<DeviceAnswer> {
        if (!find_in_slot(finder, slot, mesh, query)) return {};
        launches_.mark_reported(question);
        return finder.show();
    });
}
std::optional<DeviceAnswer> FeatureCalls::find_again(std::size_t slot, const DeviceShape& mesh,
                                                     const FeatureRequest& query) {
    return again_with(features_, asked(query), slot, mesh, query);
}
std::optional<DeviceAnswer> FeatureCalls::find_again(std::size_t slot, const DeviceShape& mesh,
                                                     const CandidateRequest& query) {
    return again_with(candidates_, Asked::candidates, slot, mesh, query);
}

}  // namespace crumple::cuda
