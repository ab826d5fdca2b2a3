#include "detector/mesh_calls.h"

#include <utility>

#include "base/stopwatch.h"
#include "partition/part_centres.h"
#include "partition/parts_of_scene.h"
#include "search/pair_stream.h"

namespace crumple {

template <class Work, class OnDevice>
void MeshCalls::run_on_meshes(const MeshView& a, const MeshView* b, const Part* part, const IntersectionQuery& query,
                              std::stop_token stop, Work work, OnDevice on_device) {
    const auto attempt = [&] {
        cancellation.check();
        check_query(a, b, query);
        if (part) {
            check_part(*part);
            check(!part->features, "the part was made for a query about features");
        }
        if (a.memory == MemorySpace::host)
            work(prepare_scene(a, b, query.weld, *backend, buffers));
        else
            on_device();
    };
    run(std::move(stop), attempt, [&](std::int64_t least) { return least <= meter.limit; });
}

const Intersections& MeshCalls::find_pairs(const MeshView& a, const MeshView* b, const Part* part,
                                           const IntersectionQuery& query, std::stop_token stop) {
    Stopwatch watch;
    clear(result);
    run_on_meshes(
        a, b, part, query, std::move(stop),
        [&](const PreparedScene& scene) { backend->find(scene, query, part, result); },
        [&] { backend->find(a, b, query, result); });
    if (part) name_globally(*part, result.pairs);
    result.count = static_cast<std::int64_t>(result.pairs.size());
    result.any = result.count > 0;
    result.statistics.triangles = a.triangles.rows + (b ? b->triangles.rows : 0);
    result.statistics.pairs = result.count;
    result.statistics.peak_memory_bytes = meter.peak;
    result.statistics.milliseconds = watch.lap();
    return result;
}

// Adds the pairs of a part to the result of an overlap query.
void MeshCalls::add_pairs(const Part& part, const BodyPair& bodies) {
    const MeshView first = part.mesh.view(), second = part.second ? part.second->view() : MeshView();
    const PreparedScene scene = prepare_scene(first, part.second ? &second : nullptr, false, *backend, buffers);
    Intersections found = metered(&meter);
    backend->find(scene, IntersectionQuery(), &part, found);
    name_globally(part, found.pairs);
    overlaps.part_pairs.grow_by(found.pairs.size());
    overlaps.part_bodies.grow_by(found.pairs.size());
    for (const Pair& pair : found.pairs) {
        overlaps.part_pairs.push_back(pair);
        overlaps.part_bodies.push_back(bodies);
    }
    add_pass(found.statistics, overlaps.statistics);
}

const Overlaps& MeshCalls::find(const Part& part, const OverlapQuery& query, std::stop_token stop) {
    Stopwatch watch;
    const bool two = part.second.has_value(), within = query.self_overlaps || !two;
    const auto attempt = [&] {
        cancellation.check();
        clear(overlaps);
        check_part(part);
        check(!part.features, "the part was made for a query about features");
        const MeshView second = two ? part.second->view() : MeshView();
        as_world(part.mesh.view(), two ? &second : nullptr,
                 [&](const World& world) { check_query_options(query, world); });
        if (within) add_pairs(two ? part_within(part, 0) : part, {0, 0});
        if (two) add_pairs(part, {0, 1});
        if (two && within) add_pairs(part_within(part, 1), {1, 1});
    };
    run(std::move(stop), attempt, [&](std::int64_t least) { return least <= meter.limit; });
    overlaps.part = {part.index, part.count, within};
    overlaps.statistics.triangles = part.triangle_count();
    overlaps.statistics.pairs = static_cast<std::int64_t>(overlaps.part_pairs.size());
    overlaps.statistics.peak_memory_bytes = meter.peak;
    overlaps.statistics.milliseconds = watch.lap();
    return overlaps;
}

const Intersections& MeshCalls::find(const MeshView& a, const MeshView* b, const IntersectionQuery& query,
                                     std::stop_token stop) {
    if (query.output == Output::pairs || query.output == Output::contacts)
        return find_pairs(a, b, nullptr, query, std::move(stop));
    if (query.output == Output::any && !query.containment) {
        const bool found = any(a, b, query, std::move(stop));
        clear(result);
        result.any = found;
        return result;
    }
    return as_world(a, b, [&](const World& world) -> const Intersections& {
        check_query(a, b, query);
        return find(world, query, std::move(stop));
    });
}

bool MeshCalls::any(const MeshView& a, const MeshView* b, const IntersectionQuery& query, std::stop_token stop) {
    bool found = false;
    run_on_meshes(
        a, b, nullptr, query, std::move(stop), [&](const PreparedScene& scene) { found = backend->any(scene, query); },
        [&] { found = backend->any(a, b, query); });
    return found;
}

Statistics MeshCalls::stream(const MeshView& a, const MeshView* b, const IntersectionQuery& query,
                             Sink<IntersectionQuery> take, std::int64_t block_rows, std::stop_token stop) {
    Stopwatch watch;
    check_blocks(block_rows);
    check_in_blocks(query);
    if (meter.limit > 0) free_caches();  // do not retry once a block has been delivered
    Statistics statistics;
    std::int64_t pairs = 0;
    const auto count = [&](const Intersections& block) {
        pairs += block.count;
        take(block);
    };
    run_on_meshes(
        a, b, nullptr, query, std::move(stop),
        [&](const PreparedScene& scene) {
            stream_pairs(*backend, scene, query, block_rows, meter, cancellation, count, statistics);
        },
        [] { check(false, "meshes must be in host memory for blocks"); });
    statistics.triangles = a.triangles.rows + (b ? b->triangles.rows : 0);
    statistics.pairs = pairs;
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return statistics;
}

LaunchNumber MeshCalls::launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query) {
    return run_launch([&] {
        check_query(a, b, query);
        check(!query.containment, "containment must be false: launches do not support it");
        if (a.memory == MemorySpace::host)
            throw Error(ErrorCode::invalid_argument, "launches need meshes in device memory");
        return backend->launch(a, b, query);
    });
}

LaunchNumber MeshCalls::launch(const World& world, const IntersectionQuery& query) {
    return run_launch([&] {
        check(lies_on_device(world) || world.bodies.empty(), "launches of worlds need poses in device memory");
        check_query_options(query);
        check_device_poses(world);
        check_on_device(query);
        return backend->launch(world, query);
    });
}

const DeviceIntersections& MeshCalls::wait(const IntersectionQuery*, LaunchNumber launch, std::stop_token stop) {
    const DeviceIntersections* found = nullptr;
    run_wait(std::move(stop), [&] { found = &backend->wait(launch); });
    return *found;
}

const Intersections& MeshCalls::download(LaunchNumber launch) {
    clear(result);
    run_launched([&] { backend->download(launch, result); });
    result.count = static_cast<std::int64_t>(result.pairs.size());
    result.any = result.count > 0;
    return result;
}

Clustering MeshCalls::cluster(const MeshView& a, const MeshView* b, std::stop_token stop) {
    Clustering clustering;
    run_on_meshes(
        a, b, nullptr, {}, std::move(stop), [&](const PreparedScene& scene) { clustering = backend->cluster(scene); },
        [] { check(false, "clusters need meshes in host memory"); });
    return clustering;
}

std::vector<Part> MeshCalls::partition(const MeshView& a, const MeshView* b, int count, std::stop_token stop) {
    if (count < 1 || count > max_parts) {
        free_caches();
        throw Error(ErrorCode::invalid_argument, "the number of parts must be 1 to 262144", Element::option);
    }
    std::vector<Part> parts;
    run_on_meshes(
        a, b, nullptr, {}, std::move(stop),
        [&](const PreparedScene& scene) { parts = make_parts(scene, count, *backend); },
        [&] { parts = backend->partition(a, b, count); });
    return parts;
}

}  // namespace crumple
