#pragma once

// A detector's calls on the triangles of one mesh or two, which it checks and hands to a backend; and launches of
// intersections.

#include <stop_token>
#include <vector>

#include "detector/world_calls.h"

namespace crumple {

/// `b` is null for one mesh.
struct MeshCalls : WorldCalls {
    using WorldCalls::find, WorldCalls::launch, WorldCalls::partition, WorldCalls::stream, WorldCalls::wait,
        WorldCalls::WorldCalls;

    const Intersections& find(const MeshView& a, const MeshView* b, const IntersectionQuery& query,
                              std::stop_token stop);
    /// Finds pairs of one mesh or two, or those that a part owns.
    const Intersections& find_pairs(const MeshView& a, const MeshView* b, const Part* part,
                                    const IntersectionQuery& query, std::stop_token stop);
    bool any(const MeshView& a, const MeshView* b, const IntersectionQuery& query, std::stop_token stop);
    Statistics stream(const MeshView& a, const MeshView* b, const IntersectionQuery& query,
                      Sink<IntersectionQuery> take, std::int64_t block_rows, std::stop_token stop);
    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count, std::stop_token stop);

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
    /// Runs `work` on the prepared scene, or on_device() where the meshes lie on a device.
    template <class Work, class OnDevice>
    void run_on_meshes(const MeshView& a, const MeshView* b, const Part* part, const IntersectionQuery& query,
                       std::stop_token stop, Work work, OnDevice on_device);
};

}  // namespace crumple
