// Queries about the features of a mesh in device memory. The host downloads the triangles once, and finds the edges and
// the triangles that own features. In each call the device compares its triangles with the downloaded ones; if they
// differ, the host downloads them again. Everything else stays on the device.

#include <optional>
#include <type_traits>
#include <variant>

#include "crumple/error.h"
#include "search/feature_search.h"

namespace crumple {
namespace {

bool device_supports_filter(const Shape& shape, const PairFilter& rules) {
    // Features that no triangle names have a group only in scenes that are made from bodies, and here the scene is a
    // mesh.
    const bool by_groups = rules.groups != PairScope::both || !rules.excluded_groups.empty();
    return rules.bodies == PairScope::both && rules.excluded_bodies.empty() &&
           !(by_groups && (shape.edges || shape.points));
}

/// Throws Error for queries that the device cannot run: Detector::find runs them on the host, but launches cannot.
template <class Query>
void require_device_support(const Shape& shape, const Query& query) {
    if (FeatureSearch::supports_on_device(shape, query)) return;
    throw Error(
        ErrorCode::invalid_argument,
        std::is_same_v<Query, ImpactQuery>
            ? "launches do not support triangle_pairs, weld, filters of bodies, or filters of groups together with "
              "codimensional edges or points; use find(), which copies the mesh to the host"
        : std::is_same_v<Query, ProximityQuery>
            ? "launches do not support closest, least, weld, filters of bodies, or filters of groups together "
              "with codimensional edges or points; use find(), which copies the mesh to the host"
            : "launches do not support weld, filters of bodies, or filters of groups together with "
              "codimensional edges or points; use find(), which copies the mesh to the host",
        Element::option);
}

}  // namespace

bool FeatureSearch::supports_on_device(const Shape& shape, const ImpactQuery& query) {
    return !query.weld && !query.triangle_pairs && device_supports_filter(shape, query.filter);
}
bool FeatureSearch::supports_on_device(const Shape& shape, const ProximityQuery& query) {
    return !query.weld && !query.closest && !query.least && device_supports_filter(shape, query.filter);
}
bool FeatureSearch::supports_on_device(const Shape& shape, const CandidateQuery& query) {
    return !query.weld && device_supports_filter(shape, query.filter);
}

// Downloads the triangles of the mesh, and makes its features from them.
void FeatureSearch::download_features(BackendBase& backend, const DeviceShape& mesh) {
    HostShape host;
    backend.device_feature_calls().copy_to_host(mesh, Copied::topology, host);
    const Shape& shape = host.shape;
    const PreparedScene scene =
        prepare_scene(MeshView(shape.vertices, shape.triangles), nullptr, false, backend, buffers_);
    features_.prepare(scene, false, backend, checked_lists(shape, ""));
}

// Runs a search on the device by calling the function that is the last argument. While this function returns nothing,
// because the mesh no longer has the triangles that the features were made from, makes the features anew and calls it
// again.
template <class Query, class Ask>
auto FeatureSearch::run_on_device(BackendBase& backend, const DeviceShape& mesh, const Query& query, Ask ask) {
    scene_filter_.prepare(query.filter);
    if (!features_.has_counts_of(mesh.shape)) download_features(backend, mesh);
    for (;; download_features(backend, mesh)) {
        cancellation_.check();
        FeatureRequest request = request_of(query, low_memory_, features_, scene_filter_);
        if constexpr (is_near<Query>) proximity_input_.tell(mesh.shape.vertices.rows, backend, cancellation_, request);
        if (auto answer = ask(request)) return answer;
    }
}

template <class Query>
void FeatureSearch::find_rows_on_device(BackendBase& backend, const Query& query) {
    run_on_device(backend, *device_mesh_, query, [&](const FeatureRequest& request) {
        return backend.device_feature_calls().find(*device_mesh_, request, found_);
    });
}

template <class Query>
void FeatureSearch::find_on_device(BackendBase& backend, const DeviceShape& mesh, const Query& query, bool low_memory,
                                   typename Query::Result& result) {
    bodies_ = false;
    low_memory_ = low_memory;
    const Body body{.self = true};
    struct There {
        const DeviceShape*& there;
        ~There() { there = nullptr; }
    } const there{device_mesh_ = &mesh};
    search(backend, {{&mesh.shape, 1}, {&body, 1}, {}, {}}, query, result);
}

// Reads the inputs of a launch, before its first run and before a repetition.
template <class Query>
void FeatureSearch::read_on_device(BackendBase& backend, const DeviceShape& mesh, const Query& query) {
    low_memory_ = false;
    const Body body{.self = true};
    read({{&mesh.shape, 1}, {&body, 1}, {}, {}}, query.filter);
    if constexpr (is_near<Query>) {
        proximity_input_.begin(outline_, query, false, false, backend, buffers_);
        proximity_input_.place(mesh.shape);
    }
}

template <class Query>
LaunchNumber FeatureSearch::launch(BackendBase& backend, const DeviceShape& mesh, const Query& query) {
    DeviceFeatureCalls& there = backend.device_feature_calls();
    require_device_support(mesh.shape, query);
    read_on_device(backend, mesh, query);
    if (there.is_captured(mesh) && !features_.has_counts_of(mesh.shape)) fail_unprepared_capture(false);
    const LaunchNumber launched =
        run_on_device(backend, mesh, query, [&](const auto& request) { return there.launch(mesh, request); });
    launched_[launched % most_in_flight] = {mesh, query};
    return launched;
}

AnyDeviceResult FeatureSearch::wait(BackendBase& backend, LaunchNumber launch) {
    DeviceFeatureCalls& there = backend.device_feature_calls();
    const Launched& launched = launched_[launch % most_in_flight];
    std::optional<AnyDeviceResult> answer = there.wait(launch);
    if (!answer)
        answer = std::visit(
            [&](const auto& query) {
                read_on_device(backend, launched.mesh, query);
                return run_on_device(backend, launched.mesh, query, [&](const auto& request) {
                    return there.find_again(launch, launched.mesh, request);
                });
            },
            launched.query);
    answer->statistics.triangles = launched.mesh.shape.triangles.rows;
    answer->statistics.pairs = answer->count;
    return *answer;
}

template void FeatureSearch::find_on_device(BackendBase&, const DeviceShape&, const ImpactQuery&, bool, Impacts&);
template void FeatureSearch::find_on_device(BackendBase&, const DeviceShape&, const ProximityQuery&, bool,
                                            Proximities&);
template void FeatureSearch::find_on_device(BackendBase&, const DeviceShape&, const CandidateQuery&, bool, Candidates&);
template void FeatureSearch::find_rows_on_device(BackendBase&, const ImpactQuery&);
template void FeatureSearch::find_rows_on_device(BackendBase&, const ProximityQuery&);
template void FeatureSearch::find_rows_on_device(BackendBase&, const CandidateQuery&);
template LaunchNumber FeatureSearch::launch(BackendBase&, const DeviceShape&, const ImpactQuery&);
template LaunchNumber FeatureSearch::launch(BackendBase&, const DeviceShape&, const ProximityQuery&);
template LaunchNumber FeatureSearch::launch(BackendBase&, const DeviceShape&, const CandidateQuery&);

}  // namespace crumple
