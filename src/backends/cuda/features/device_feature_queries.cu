#include "backends/cuda/features/device_feature_queries.h"

#include "backends/cuda/input/host_shape.h"
#include "crumple/error.h"
#include "results/owned_features.h"

namespace crumple::cuda {

FeatureCalls::FeatureCalls(BackendState& state, Launches& launches)
    : state_(state),
      launches_(launches),
      device_features_(state.stream.get(), state.meter, state.launches_in_flight),
      features_(state, device_features_),
      candidates_(state, device_features_) {}

void FeatureCalls::release() {
    features_.release();
    candidates_.release();
    device_features_.release();
}

RowFinder& FeatureCalls::finder_for(const FeatureRequest& request) {
    if (request.criterion == Criterion::candidate) return candidates_;
    return features_;
}

void FeatureCalls::find_all(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) {
    with_device(state_.device, [&] {
        launches_.finish();
        result.clear();
        result.statistics.backend = "cuda";
        if (scene.triangle_count() == 0) return;  // lists have a minimum size, which may exceed the memory limit
        RowFinder& finder = finder_for(request);
        finder.bring(finder.current(), scene, request);
        finder.find();
        finder.copy_to(result);
    });
}
// For a request about a part (crumple/part.h), finds all pairs among its triangles, then drops those that another part
// owns.
void FeatureCalls::find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) {
    if (!request.part) return find_all(scene, request, result);
    FeatureRequest all = request;
    all.part = nullptr;
    all.extent = Extent::all;
    find_all(scene, all, result);
    keep_owned(scene, request, result);
}

bool FeatureCalls::is_captured(const DeviceShape& mesh) {
    return with_device(state_.device, [&] { return capture_of(static_cast<cudaStream_t>(mesh.stream)) != 0; });
}

void FeatureCalls::copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) {
    with_device(state_.device, [&] {
        ReadableArrays(state_.device.index()).check(mesh.shape);
        state_.follow(mesh.stream, "a mesh's");
        cuda::copy_to_host(mesh.shape, what, state_.stream.get(), host);
    });
}

// Returns false if the mesh on the device no longer has the features to which the request refers.
bool FeatureCalls::find_in_slot(RowFinder& finder, const DeviceShape& mesh, const FeatureRequest& request) {
    try {
        state_.follow(mesh.stream, "a mesh's");
        finder.view(finder.current(), mesh.shape, request);
        finder.find();
        return true;
    } catch (const MeshChanged&) {
        return false;
    }
}

bool FeatureCalls::find(const DeviceShape& mesh, const FeatureRequest& request, FeatureResult& result) {
    return with_device(state_.device, [&] {
        launches_.finish();
        result.clear();
        RowFinder& finder = finder_for(request);
        if (!find_in_slot(finder, mesh, request)) return false;
        finder.copy_to(result);
        return true;
    });
}

LaunchNumber FeatureCalls::launch(const DeviceShape& mesh, const FeatureRequest& request) {
    RowFinder& finder = finder_for(request);
    const auto stream = static_cast<cudaStream_t>(mesh.stream);
    const auto bind = [&](std::size_t slot, Growth growth) { finder.view(slot, mesh.shape, request, growth); };
    const LaunchNumber launch =
        with_device(state_.device, [&] { return launches_.launch(finder, stream, stream, bind); });
    launched_[launch % most_in_flight] = &finder;
    return launch;
}

std::optional<AnyDeviceResult> FeatureCalls::wait(LaunchNumber launch) {
    launches_.check_awaited(launch);
    RowFinder& finder = *launched_[launch % most_in_flight];
    return with_device(state_.device, [&]() -> std::optional<AnyDeviceResult> {
        const Launches::Outcome outcome = launches_.wait(finder, device_features_.known().revision);
        if (outcome == Launches::Outcome::lost) return {};
        launches_.mark_reported(launch);
        return outcome == Launches::Outcome::complete ? finder.show() : finder.show_incomplete();
    });
}

std::optional<AnyDeviceResult> FeatureCalls::find_again(LaunchNumber launch, const DeviceShape& mesh,
                                                        const FeatureRequest& request) {
    return with_device(state_.device, [&]() -> std::optional<AnyDeviceResult> {
        RowFinder& finder = *launched_[launch % most_in_flight];
        if (!find_in_slot(finder, mesh, request)) return {};
        launches_.mark_reported(launch);
        return finder.show();
    });
}

}  // namespace crumple::cuda
