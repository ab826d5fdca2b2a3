#pragma once

// Search engine of a rank: searches one part after another, or whole bodies, under the rank's memory limit.

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <utility>

#include "crumple/part.h"
#include "detector/world_calls.h"

namespace crumple::distribute {

class PartSearch : private WorldCalls {
   public:
    explicit PartSearch(const Options& options) : WorldCalls(options) {}

    /// Returns the pairs that the part owns, as indices of triangles within the part. Valid until the next call.
    /// `memory`: per-scene cache of the part.
    const Intersections& find(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
                              std::stop_token stop);
    /// True if there is a pair among the part's triangles.
    bool any(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
             std::stop_token stop);

    /// Returns the pairs of features that the part owns, by id. Valid until the next call.
    const Impacts& find(const Part& part, const ImpactQuery& query, std::unique_ptr<SceneMemory>& memory,
                        std::stop_token stop);
    const Proximities& find(const Part& part, const ProximityQuery& query, std::unique_ptr<SceneMemory>& memory,
                            std::stop_token stop);

    /// Reads the surfaces of the bodies of a world, and calls use(surfaces).
    void read_surfaces(const World& world, bool weld, std::stop_token stop, FunctionRef<void(const ClosedBodies&)> use);
    /// Returns the overlaps of a world as Detector::find does. Valid until the next call.
    const Overlaps& find(const World& world, const OverlapQuery& query, std::stop_token stop) {
        return WorldCalls::find(world, query, std::move(stop));
    }

    /// Finds the overlap of a mesh with itself. `pairs`: all pairs of triangles that intersect, in any order; emptied.
    void find(const MeshView& mesh, const OverlapQuery& query, Array<Pair>& pairs, std::stop_token stop,
              Overlaps& rows);

    /// See Detector::set_poll.
    void set_poll(std::function<void()> poll) { cancellation.set_poll(std::move(poll)); }

    ParallelFor& workers() { return *backend; }
    /// Downloads a mesh. Throws Error unless the backend is cuda.
    void copy_to_host(const DeviceShape& there, HostShape& here) {
        backend->device_feature_calls().copy_to_host(there, Copied::all, here);
    }
    MemoryMeter& memory() { return meter; }
    void release() { free_caches(); }

   private:
    template <class Query, class Result>
    const Result& find_features(const Part& part, const Query& query, std::unique_ptr<SceneMemory>& memory,
                                std::stop_token stop, Result& result);
    template <class Work>
    void guarded(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
                 std::stop_token stop, Work work);
};

}  // namespace crumple::distribute
