// Detector calls about the features of one mesh, in host or device memory, and of parts.

#include <utility>

#include "detector/world_calls.h"
#include "partition/part_centres.h"

namespace crumple {
namespace {

void tell(const DeviceRows& rows, DeviceImpactList& list) { list = {rows.count, rows.pairs, rows.value, rows.flag}; }
void tell(const DeviceRows& rows, DeviceProximityList& list) { list = {rows.count, rows.pairs, rows.value, rows.flag}; }
void tell(const DeviceRows& rows, DeviceCandidateList& list) { list = {rows.count, rows.pairs}; }

template <class Answer>
void tell(const AnyDeviceResult& found, Answer& answer) {
    static_cast<DeviceFeatures&>(answer) = found;
    const bool all_kinds = answer.lists.size() == candidate_kinds;
    for (std::size_t k = 0; k < answer.lists.size(); ++k) {
        const auto kind = all_kinds ? static_cast<CandidateKind>(k) : candidate_kind(static_cast<FeatureKind>(k));
        tell(found.rows[static_cast<std::size_t>(kind)], answer.lists[k]);
    }
    if constexpr (requires { answer.any; }) answer.any = found.any;
    if constexpr (requires { answer.first; }) answer.first = found.first;
}

constexpr Body whole{.self = true};
World world_of(const Shape& shape) { return {{&shape, 1}, {&whole, 1}, {}, {}}; }

}  // namespace

void WorldCalls::refuse(const char* message) {
    free_caches();
    throw Error(ErrorCode::invalid_argument, message, Element::option);
}
void WorldCalls::require_host(const MeshView& mesh) {
    if (mesh.memory != MemorySpace::host)
        refuse("meshes must be in host memory for blocks and parts of features, and if they are handled as bodies");
}
Shape WorldCalls::shape_of(const MeshView& mesh, const ImpactQuery&) {
    if (!mesh.end.data && mesh.end.rows == 0 && mesh.vertices.rows > 0)
        refuse("the vertices at the end are missing; a query about motion needs them");
    if (mesh.vertices.rows > most_moving_vertices) refuse(too_many_moving_vertices);
    return Shape(mesh);
}
Shape WorldCalls::shape_of(const MeshView& mesh, const ProximityQuery& query) {
    Shape shape(mesh);
    shape.end = {};
    shape.radii = query.radii;
    shape.rest = query.rest;
    return shape;
}
Shape WorldCalls::shape_of(const MeshView& mesh, const CandidateQuery&) {
    const bool moves = mesh.end.data || mesh.end.rows > 0;
    if (moves && mesh.vertices.rows > most_moving_vertices) refuse(too_many_moving_vertices);
    return Shape(mesh);
}

template <FeatureQuery Query>
const typename Query::Result& WorldCalls::find(const MeshView& mesh, const Query& query, std::stop_token stop) {
    const Shape shape = shape_of(mesh, query);
    if (mesh.memory == MemorySpace::host) return find_features(world_of(shape), query, false, std::move(stop));
    const DeviceShape there{shape, mesh.stream};
    if (FeatureSearch::supports_on_device(shape, query)) return find_on_device(there, query, std::move(stop));
    HostShape copy;
    copy_to_host(there, copy);
    return find_features(world_of(copy.shape), query, false, std::move(stop));
}

template <class Query>
const typename Query::Result& WorldCalls::find_on_device(const DeviceShape& mesh, const Query& query,
                                                         std::stop_token stop) {
    auto& result = result_of(query);
    return run_with_retry(result, std::move(stop), [&](bool low_memory) {
        check_query_options(query, false);
        check_groups(query.filter, mesh.shape.triangles.rows, !mesh.shape.groups.empty());
        features.find_on_device(*backend, mesh, query, low_memory, result);
    });
}

template <FeatureQuery Query>
Statistics WorldCalls::stream(const MeshView& mesh, const Query& query, Sink<Query> take, std::int64_t block_rows,
                              std::stop_token stop) {
    require_host(mesh);
    const Shape shape = shape_of(mesh, query);
    return stream_features(world_of(shape), query, false, {block_rows, take}, std::move(stop));
}

template <FeatureQuery Query>
std::vector<Part> WorldCalls::partition(const MeshView& mesh, const Query& query, int count, std::stop_token stop) {
    require_host(mesh);
    const Shape shape = shape_of(mesh, query);
    std::vector<Part> parts;
    const auto attempt = [&] {
        check(count >= 1 && count <= max_parts, "the number of parts must be 1 to 262144");
        check_query_options(query, false);
        parts = features.partition(*backend, world_of(shape), query, count);
    };
    run(std::move(stop), attempt, [](std::int64_t) { return true; });
    return parts;
}

template <FeatureQuery Query>
const typename Query::Result& WorldCalls::find(const Part& part, const Query& query, std::stop_token stop) {
    auto& result = result_of(query);
    return run_with_retry(result, std::move(stop), [&](bool low_memory) {
        check_query_options(query, false);
        check_groups(query.filter, part.mesh.size(), !part.mesh.groups.empty());
        features.find(*backend, part, query, low_memory, result);
    });
}

void WorldCalls::copy_to_host(const DeviceShape& mesh, HostShape& copy) {
    run(
        {}, [&] { backend->device_feature_calls().copy_to_host(mesh, Copied::all, copy); },
        [](std::int64_t) { return false; });
}
void WorldCalls::copy_to_host(const MeshView& mesh, HostShape& copy) {
    copy_to_host({shape_of(mesh, CandidateQuery()), mesh.stream}, copy);  // with vertices at the end, if there are any
}

template <FeatureQuery Query>
LaunchNumber WorldCalls::launch(const MeshView& mesh, const Query& query) {
    const DeviceShape there{shape_of(mesh, query), mesh.stream};
    return run_launch([&] {
        check_query_options(query, false);
        check_groups(query.filter, mesh.triangles.rows, !mesh.groups.empty());
        check(mesh.memory != MemorySpace::host, "launches need meshes in device memory");
        return features.launch(*backend, there, query);
    });
}

template <FeatureQuery Query>
const typename Query::DeviceResult& WorldCalls::wait(const Query*, LaunchNumber launch, std::stop_token stop) {
    auto& result = std::get<typename Query::DeviceResult>(launched_[launch % most_in_flight]);
    run_wait(std::move(stop), [&] { tell(features.wait(*backend, launch), result); });
    return result;
}

template const Impacts& WorldCalls::find(const MeshView&, const ImpactQuery&, std::stop_token);
template const Proximities& WorldCalls::find(const MeshView&, const ProximityQuery&, std::stop_token);
template const Candidates& WorldCalls::find(const MeshView&, const CandidateQuery&, std::stop_token);
template const Impacts& WorldCalls::find(const Part&, const ImpactQuery&, std::stop_token);
template const Proximities& WorldCalls::find(const Part&, const ProximityQuery&, std::stop_token);
template Statistics WorldCalls::stream(const MeshView&, const ImpactQuery&, Sink<ImpactQuery>, std::int64_t,
                                       std::stop_token);
template Statistics WorldCalls::stream(const MeshView&, const ProximityQuery&, Sink<ProximityQuery>, std::int64_t,
                                       std::stop_token);
template Statistics WorldCalls::stream(const MeshView&, const CandidateQuery&, Sink<CandidateQuery>, std::int64_t,
                                       std::stop_token);
template std::vector<Part> WorldCalls::partition(const MeshView&, const ImpactQuery&, int, std::stop_token);
template std::vector<Part> WorldCalls::partition(const MeshView&, const ProximityQuery&, int, std::stop_token);
template LaunchNumber WorldCalls::launch(const MeshView&, const ImpactQuery&);
template LaunchNumber WorldCalls::launch(const MeshView&, const ProximityQuery&);
template LaunchNumber WorldCalls::launch(const MeshView&, const CandidateQuery&);
template const DeviceImpacts& WorldCalls::wait(const ImpactQuery*, LaunchNumber, std::stop_token);
template const DeviceProximities& WorldCalls::wait(const ProximityQuery*, LaunchNumber, std::stop_token);
template const DeviceCandidates& WorldCalls::wait(const CandidateQuery*, LaunchNumber, std::stop_token);

}  // namespace crumple
