#include "search/containment/containment_search.h"

#include "results/world_output.h"
#include "search/containment/contained_bodies.h"

namespace crumple {

void find_with_containment(BackendBase& backend, ParallelFor& host, WorldSearch& worlds, ClosedBodies& bodies,
                           const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                           Cancellation& cancellation, Intersections& result) {
    worlds.find(backend, world, query, result);
    if (query.output == Output::body_pairs) result.inside.assign(result.bodies.size(), 0);
    if (query.output == Output::any && result.any) return;
    bodies.read(host, world, query.filter, query.weld);
    Array<BodyPair> pairs = bodies.near_pairs(false);
    leave_undecided(bodies.outline(), query.output, result, pairs);
    for (const std::int32_t body : bodies.open_bodies(pairs.span(), query.open, "IntersectionQuery"))
        result.skipped.push_back(body);
    ContainedBodies(meter, cancellation, bodies, query.weld).add(host, pairs.span(), query.output, result);
}

}  // namespace crumple
