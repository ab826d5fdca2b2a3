#pragma once

// Detector calls on worlds of bodies, and on features. For queries about features, a mesh is a world of one body.

#include <concepts>
#include <span>
#include <stop_token>
#include <tuple>
#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "crumple/detector.h"
#include "detector/detector_state.h"

namespace crumple {

template <class Query>
using Sink = FunctionRef<void(const typename Query::Result& block)>;

/// True if a query is about the features of triangles.
template <class Query>
concept FeatureQuery =
    std::same_as<Query, ImpactQuery> || std::same_as<Query, ProximityQuery> || std::same_as<Query, CandidateQuery>;

struct WorldCalls : DetectorState {
    using DetectorState::DetectorState;

    // Calls on worlds:
    const Intersections& find(const World& world, const IntersectionQuery& query, std::stop_token stop,
                              const WorldBlocks* blocks = nullptr);
    Statistics stream(const World& world, const IntersectionQuery& query, Sink<IntersectionQuery> take,
                      std::int64_t block_rows, std::stop_token stop);
    const Distances& find(const World& world, const DistanceQuery& query, std::stop_token stop);
    const Overlaps& find(const World& world, const OverlapQuery& query, std::stop_token stop);
    Statistics stream(const World& world, const OverlapQuery& query, Sink<OverlapQuery> take, std::int64_t block_rows,
                      std::stop_token stop);
    /// Returns the overlaps of meshes, given as a world without poses, from the results for all their parts.
    const Overlaps& combine(const World& world, const OverlapQuery& query, std::span<const Overlaps> parts,
                            std::stop_token stop);
    template <FeatureQuery Query>
    const typename Query::Result& find(const World& world, const Query& query, std::stop_token stop) {
        return find_features(world, query, true, std::move(stop));
    }
    template <FeatureQuery Query>
    Statistics stream(const World& world, const Query& query, Sink<Query> take, std::int64_t block_rows,
                      std::stop_token stop) {
        return stream_features(world, query, true, {block_rows, take}, std::move(stop));
    }

    // Calls on the features of one mesh:
    template <FeatureQuery Query>
    const typename Query::Result& find(const MeshView& mesh, const Query& query, std::stop_token stop);
    template <FeatureQuery Query>
    Statistics stream(const MeshView& mesh, const Query& query, Sink<Query> take, std::int64_t block_rows,
                      std::stop_token stop);
    template <FeatureQuery Query>
    std::vector<Part> partition(const MeshView& mesh, const Query& query, int count, std::stop_token stop);
    template <FeatureQuery Query>
    LaunchNumber launch(const MeshView& mesh, const Query& query);
    template <FeatureQuery Query>
    const typename Query::DeviceResult& wait(const Query*, LaunchNumber launch, std::stop_token stop);
    void copy_to_host(const MeshView& mesh, HostShape& copy);

    template <FeatureQuery Query>
    const typename Query::Result& find(const Part& part, const Query& query, std::stop_token stop);

    /// Frees all cached memory, then throws Error (invalid_argument).
    [[noreturn]] void refuse(const char* message);

    /// Throws Error unless the mesh is in host memory.
    void require_host(const MeshView& mesh);

   private:
    void search(const World& world, const IntersectionQuery& query, const WorldBlocks* blocks);
    void search(const World& world, const OverlapQuery& query, const OverlapBlocks* blocks);
    void find_reference_overlaps(const World& world, const OverlapQuery& query);
    bool try_on_device(const World& world, const IntersectionQuery& query);
    /// `bodies`: true if the result names bodies; false for a single mesh.
    template <class Query>
    const typename Query::Result& find_features(const World& world, const Query& query, bool bodies,
                                                std::stop_token stop);
    template <class Query>
    Statistics stream_features(const World& world, const Query& query, bool bodies,
                               const FeatureBlocks<typename Query::Result>& blocks, std::stop_token stop);
    /// Runs search(false) under the memory limit and returns the result. If this exceeds the limit, which may depend on
    /// the scheduling of workers, runs search(true): a low-memory search (FeatureRequest::low_memory).
    template <class Result, class Search>
    const Result& run_with_retry(Result& result, std::stop_token stop, Search search) {
        Stopwatch watch;
        bool low_memory = false;
        const auto attempt = [&] { search(low_memory); };
        run(std::move(stop), attempt, [&](std::int64_t) { return low_memory = true; });
        result.statistics.peak_memory_bytes = meter.peak;
        result.statistics.milliseconds = watch.lap();
        return result;
    }
    template <class Query>
    const typename Query::Result& find_on_device(const DeviceShape& mesh, const Query& query, std::stop_token stop);
    void copy_to_host(const DeviceShape& mesh, HostShape& copy);

    /// Returns the mesh as a shape with everything that the query reads. Throws Error if an impact query lacks end
    /// positions, or a moving mesh has too many vertices.
    Shape shape_of(const MeshView& mesh, const ImpactQuery& query);
    Shape shape_of(const MeshView& mesh, const ProximityQuery& query);
    Shape shape_of(const MeshView& mesh, const CandidateQuery& query);

    /// Results of the last launches, by launch number modulo most_in_flight.
    std::tuple<DeviceImpacts, DeviceProximities, DeviceCandidates> launched_[most_in_flight];
};

}  // namespace crumple
