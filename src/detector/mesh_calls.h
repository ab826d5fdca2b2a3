#pragma once

// Detector calls on the triangles of one mesh or two: checks them and forwards them to a backend. Includes launches of
// intersection queries.

#include <stop_token>
#include <vector>

#include "detector/world_calls.h"

namespace crumple {

/// Intersection queries on mesh `a`, or on two meshes; `b` is null for one mesh.
struct MeshCalls : WorldCalls {
    using WorldCalls::combine, WorldCalls::find, WorldCalls::launch, WorldCalls::partition, WorldCalls::stream,
        WorldCalls::wait, WorldCalls::WorldCalls;

    const Intersections& find(const MeshView& a, const MeshView* b, const IntersectionQuery& query,
                              std::stop_token stop);
    /// Finds the pairs of one mesh or two. If `part` is not null, the meshes are those of the part, and only pairs that
    /// the part owns are found.
    const Intersections& find_pairs(const MeshView& a, const MeshView* b, const Part* part,
                                    const IntersectionQuery& query, std::stop_token stop);
    /// Finds the pairs of triangles that the part owns, of which combine() makes overlaps.
    const Overlaps& find(const Part& part, const OverlapQuery& query, std::stop_token stop);
    bool any(const MeshView& a, const MeshView* b, const IntersectionQuery& query, std::stop_token stop);
    Statistics stream(const MeshView& a, const MeshView* b, const IntersectionQuery& query,
                      Sink<IntersectionQuery> take, std::int64_t block_rows, std::stop_token stop);
    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count, std::stop_token stop);
    Clustering cluster(const MeshView& a, const MeshView* b, std::stop_token stop);

    LaunchNumber launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
    LaunchNumber launch(const World& world, const IntersectionQuery& query);
    const DeviceIntersections& wait(const IntersectionQuery*, LaunchNumber launch, std::stop_token stop);
    const Intersections& download(LaunchNumber launch);

    /// Calls work(world) with one mesh, or two, as bodies.
    template <class Work>
    decltype(auto) as_world(const MeshView& a, const MeshView* b, Work work) {
        require_host(a);
        if (b) require_host(*b);
        const Shape shapes[] = {Shape(a), b ? Shape(*b) : Shape()};
        const Body bodies[] = {{.shape = 0, .self = !b}, {.shape = 1}};
        const std::size_t n = b ? 2 : 1;
        return work(World{{shapes, n}, {bodies, n}, {}});
    }

   private:
    void add_pairs(const Part& part, const BodyPair& bodies);
    /// Runs work(prepared scene) for meshes in host memory, or on_device() for meshes in device memory.
    template <class Work, class OnDevice>
    void run_on_meshes(const MeshView& a, const MeshView* b, const Part* part, const IntersectionQuery& query,
                       std::stop_token stop, Work work, OnDevice on_device);
};

}  // namespace crumple
