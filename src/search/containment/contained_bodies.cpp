#include "search/containment/contained_bodies.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <tuple>

#include "results/world_output.h"

namespace crumple {
namespace {

constexpr std::size_t pairs_a_task = 64;

bool before(const Vec3d& p, const Vec3d& q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); }

bool holds(const Bounds& box, const Vec3d& p) { return overlap(box, Bounds{p, p}); }

/// True if `outer` contains `inner`.
bool holds(const Bounds& outer, const Bounds& inner) { return holds(outer, inner.low) && holds(outer, inner.high); }

/// Returns the world index of a pair; the number of worlds for bodies that are in all worlds.
std::int32_t world_of(const WorldOutline& outline, const BodyPair& pair) {
    const std::int32_t world = outline.body(pair.first).world;
    return world < 0 ? outline.worlds() : world;
}

/// Returns for each pair the index of the flag that it decides: by `output`, the pair's own flag, that of its world, or
/// the only flag.
std::vector<std::size_t> slots_of(const WorldOutline& outline, std::span<const BodyPair> pairs, Output output) {
    std::vector<std::size_t> slots(pairs.size(), 0);
    for (std::size_t i = 0; i < pairs.size() && output != Output::any; ++i)
        slots[i] = output == Output::body_pairs ? i : static_cast<std::size_t>(world_of(outline, pairs[i]));
    return slots;
}

}  // namespace

void leave_undecided(const WorldOutline& outline, Output output, const Intersections& found, Array<BodyPair>& pairs) {
    const auto is_decided = [&](const BodyPair& pair) {
        if (output == Output::body_pairs) return std::binary_search(found.bodies.begin(), found.bodies.end(), pair);
        const std::int32_t world = world_of(outline, pair);
        return output == Output::any || world == outline.worlds() ? found.any : found.world_hit[world] != 0;
    };
    const auto end = std::remove_if(pairs.begin(), pairs.end(), is_decided);
    pairs.resize(static_cast<std::size_t>(end - pairs.begin()));
}

void ContainedBodies::add(ParallelFor& workers, std::span<const BodyPair> pairs, Output output,
                          Intersections& result) const {
    if (pairs.empty()) return;
    const std::vector<std::size_t> slot = slots_of(bodies_.outline(), pairs, output);
    std::vector<std::atomic<bool>> is_decided(1 + *std::max_element(slot.begin(), slot.end()));
    std::vector<std::atomic<bool>> contained(pairs.size());
    Casts casts = casts_of(workers, pairs);
    std::vector<std::size_t> first;  // index of the first ray through each body
    for (std::size_t i = 0; i < casts.size(); ++i)
        if (i == 0 || casts[i].through != casts[i - 1].through) first.push_back(i);
    first.push_back(casts.size());
    workers.parallel_for(first.size() - 1, [&](std::size_t task) {
        cancellation_.check();
        Array<WindingRay> rays(&meter_);
        for (std::size_t i = first[task]; i < first[task + 1]; ++i)
            if (!is_decided[slot[casts[i].ray.of]].load(std::memory_order_relaxed)) rays.push_back(casts[i].ray);
        if (rays.empty()) return;
        Array<Vec3d> points(&meter_);
        cast_rays(rays.span(), bodies_.place(casts[first[task]].through, points), Shift::forward, cancellation_);
        for (const WindingRay& ray : rays) {
            if (ray.winding == 0) continue;
            contained[ray.of].store(true, std::memory_order_relaxed);
            is_decided[slot[ray.of]].store(true, std::memory_order_relaxed);
        }
    });
    Array<BodyPair> rows(&meter_);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (!contained[i]) continue;
        hit(world_of(bodies_.outline(), pairs[i]), bodies_.outline(), result);
        rows.push_back(pairs[i]);
    }
    if (output == Output::body_pairs) add_contained(rows.span(), result);
}

// Returns the rays of all pairs, sorted by the body that they are cast through.
ContainedBodies::Casts ContainedBodies::casts_of(ParallelFor& workers, std::span<const BodyPair> pairs) const {
    std::vector<Casts> of_task;
    const std::size_t tasks = (pairs.size() + pairs_a_task - 1) / pairs_a_task;
    for (std::size_t task = 0; task < tasks; ++task) of_task.emplace_back(&meter_);
    workers.parallel_for(tasks, [&](std::size_t task) {
        for (std::size_t i = task * pairs_a_task; i < std::min(pairs.size(), (task + 1) * pairs_a_task); ++i) {
            cancellation_.check();
            add_casts(pairs[i].first, pairs[i].second, i, of_task[task]);
            add_casts(pairs[i].second, pairs[i].first, i, of_task[task]);
        }
    });
    Casts all(&meter_);
    for (const Casts& some : of_task)
        for (const Cast& cast_rays : some) all.push_back(cast_rays);
    std::stable_sort(all.begin(), all.end(), [](const Cast& x, const Cast& y) { return x.through < y.through; });
    return all;
}

// Adds the rays of one pair from body `of` through the faces of body `through`. A component with a vertex outside of
// the box of `through` lies outside, and needs no ray. No rays are added if the surface of `through` is not closed.
void ContainedBodies::add_casts(std::int32_t of, std::int32_t through, std::size_t pair, Casts& casts) const {
    if (!bodies_.is_closed(through)) return;
    if (weld_ && add_casts_between_welded(of, through, pair, casts)) return;
    const ClosedSurface& surface = bodies_.surface(of);
    const VertexReader position = reader_of(bodies_.outline().shape(of));
    const Placement pose = bodies_.outline().placement(of);
    const Bounds& box = bodies_.box(through);
    const auto vertex_at_place = [&](std::int32_t place) { return pose(position(surface.vertex_at_place(place))); };
    const bool all_inside = holds(box, bodies_.box(of));
    const auto& first = surface.components();
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        std::int32_t place = first[c];
        while (!all_inside && place < first[c + 1] && holds(box, vertex_at_place(place))) ++place;
        if (all_inside || place == first[c + 1]) casts.push_back({through, {vertex_at_place(first[c]), pair, 0}});
    }
}

// Adds the rays for welded bodies. Returns false, and adds no rays, if the bodies have no vertices at equal positions.
bool ContainedBodies::add_casts_between_welded(std::int32_t of, std::int32_t through, std::size_t pair,
                                               Casts& casts) const {
    const Array<Vec3d> own = vertices_in(of, bodies_.box(through)), others = vertices_in(through, bodies_.box(of));
    std::vector<Vec3d> rest;
    std::set_difference(own.begin(), own.end(), others.begin(), others.end(), std::back_inserter(rest), before);
    if (rest.size() == own.size()) return false;
    for (const Vec3d& p : rest) casts.push_back({through, {p, pair, 0}});
    return true;
}

/// Returns the positions of vertices of a body's triangles in a box, in lexicographic order, each once.
Array<Vec3d> ContainedBodies::vertices_in(std::int32_t body, const Bounds& box) const {
    const ClosedSurface& surface = bodies_.surface(body);
    const VertexReader position = reader_of(bodies_.outline().shape(body));
    const Placement pose = bodies_.outline().placement(body);
    Array<Vec3d> vertices(&meter_);
    for (std::int32_t place = 0; place < surface.places(); ++place) {
        const Vec3d p = pose(position(surface.vertex_at_place(place)));
        if (holds(box, p)) vertices.push_back(p);
    }
    std::sort(vertices.begin(), vertices.end(), before);
    vertices.resize(static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin()));
    return vertices;
}

}  // namespace crumple
