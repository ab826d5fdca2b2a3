#include "backends/reference/reference_containment.h"

#include <algorithm>
#include <set>
#include <vector>

#include "backends/reference/reference_bodies.h"
#include "backends/reference/reference_worlds.h"
#include "exact/overlap/exact_crossing.h"
#include "results/intersection_output.h"
#include "results/world_output.h"

namespace crumple {
namespace {

/// Returns true if the surface of `other`, which must be closed, winds around some vertex of body `of`. `weld`: ignores
/// vertices at positions of vertices of `other`.
bool has_vertex_inside(const PosedBody& of, const PosedBody& other, bool weld, Cancellation& cancellation) {
    const auto is_vertex_of_other = [&](const Vec3d& p) {
        return std::any_of(other.used.begin(), other.used.end(),
                           [&](std::int32_t v) { return other.point[static_cast<std::size_t>(v)] == p; });
    };
    for (const std::int32_t v : of.used) {
        cancellation.check();
        const Vec3d& p = of.point[static_cast<std::size_t>(v)];
        if (weld && is_vertex_of_other(p)) continue;
        int winding = 0;
        for (std::size_t f = 0; f < other.face.size(); ++f)
            winding += winding_along_ray(p, other.corners(f), Shift::forward);
        if (winding != 0) return true;
    }
    return false;
}

}  // namespace

void find_with_containment_by_brute_force(const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                                          Cancellation& cancellation, Intersections& result) {
    IntersectionQuery surfaces = query;
    surfaces.output = Output::body_pairs;
    Intersections meeting = metered(&meter);
    find_by_brute_force(world, surfaces, meter, cancellation, meeting, nullptr);
    find_by_brute_force(world, query, meter, cancellation, result, nullptr);
    if (query.output == Output::body_pairs) result.inside.assign(result.bodies.size(), 0);
    const PosedBodies bodies(world, query.filter, query.weld, meter);
    const Array<std::uint8_t> meets = result.world_hit;
    const bool any_meets = result.any;
    std::vector<BodyPair> contained;
    std::set<std::int32_t> skipped;
    for (const BodyPair& pair : bodies.near_pairs(false)) {
        const std::int32_t in = bodies.outline().body(pair.first).world;
        if (std::binary_search(meeting.bodies.begin(), meeting.bodies.end(), pair)) continue;
        if (query.output == Output::any && any_meets) continue;
        if (query.output == Output::any_by_world && (in < 0 ? any_meets : meets[in] != 0)) continue;
        const std::vector<std::int32_t> open = bodies.open_bodies(pair, query.open, "IntersectionQuery");
        skipped.insert(open.begin(), open.end());
        const auto holds = [&](std::int32_t a, std::int32_t b) {
            return bodies[a].open.empty() && has_vertex_inside(bodies[b], bodies[a], query.weld, cancellation);
        };
        if (!holds(pair.first, pair.second) && !holds(pair.second, pair.first)) continue;
        hit(in < 0 ? bodies.outline().worlds() : in, bodies.outline(), result);
        contained.push_back(pair);
    }
    if (query.output == Output::body_pairs) add_contained(contained, result);
    for (const std::int32_t body : skipped) result.skipped.push_back(body);
}

}  // namespace crumple
