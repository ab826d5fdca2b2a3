#include "detector/world_calls.h"

#include <utility>

#include "backends/reference/reference_containment.h"
#include "backends/reference/reference_distances.h"
#include "backends/reference/reference_overlaps.h"
#include "backends/reference/reference_worlds.h"
#include "base/stopwatch.h"
#include "detector/posed_on_host.h"
#include "scene/lone_bodies.h"
#include "search/containment/containment_search.h"

namespace crumple {

const Intersections& WorldCalls::find(const World& world, const IntersectionQuery& query, std::stop_token stop,
                                      const WorldBlocks* blocks) {
    Stopwatch watch;
    bool delivered = false;
    const auto noting = [&](const Intersections& block) {
        delivered = true;
        blocks->take(block);
    };
    const auto attempt = [&] {
        if (!blocks) return search(world, query, nullptr);
        const WorldBlocks noted{blocks->most, noting};
        search(world, query, &noted);
    };
    // Do not retry once a block has been delivered.
    run(std::move(stop), attempt, [&](std::int64_t) { return !delivered; });
    Statistics& statistics = result.statistics;
    statistics.pairs = result.count;
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return result;
}

void WorldCalls::search(const World& world, const IntersectionQuery& query, const WorldBlocks* blocks) {
    check_query_options(query);
    if (query.containment) check_containment(query, world);
    check_bodies_have_triangles(world, query.filter, true, "only triangles intersect");
    const bool on_device = !blocks && !query.containment && working == Backend::cuda && lies_on_device(world);
    if (on_device && try_on_device(world, query)) return;
    const PosedOnHost there(*backend, world);
    if (working == Backend::reference && query.containment)
        find_with_containment_by_brute_force(there.world(), query, meter, cancellation, result);
    else if (working == Backend::reference)
        find_by_brute_force(there.world(), query, meter, cancellation, result, blocks);
    else if (query.containment)
        find_with_containment(*backend, host_backend(), worlds, closed_bodies, there.world(), query, meter,
                              cancellation, result);
    else
        worlds.find(*backend, there.world(), query, result, blocks);
}

// Finds all worlds at once. Returns false if the backend cannot do so, or memory does not suffice.
bool WorldCalls::try_on_device(const World& world, const IntersectionQuery& query) {
    check_device_poses(world);
    try {
        return backend->find(world, query, result);
    } catch (const MemoryMeter::Exceeded&) {
        backend->release();
        return false;
    }
}

Statistics WorldCalls::stream(const World& world, const IntersectionQuery& query, Sink<IntersectionQuery> take,
                              std::int64_t block_rows, std::stop_token stop) {
    check_blocks(block_rows);
    check_in_blocks(query);
    if (meter.limit > 0) free_caches();
    const WorldBlocks blocks{block_rows, take};
    return find(world, query, std::move(stop), &blocks).statistics;
}

const Distances& WorldCalls::find(const World& world, const DistanceQuery& query, std::stop_token stop) {
    Stopwatch watch;
    bool low_memory = false;
    const auto attempt = [&] {
        check_query_options(query);
        check_bodies_have_triangles(world, query.filter, false, "only triangles count for distances");
        const PosedOnHost there(*backend, world);
        if (working == Backend::reference)
            find_nearest_by_brute_force(there.world(), query, meter, cancellation, nearest_search);
        else
            nearest.find(host_backend(), there.world(), query, low_memory, nearest_search);
    };
    run(std::move(stop), attempt, [&](std::int64_t) { return low_memory = true; });
    nearest_search.count = static_cast<std::int64_t>(nearest_search.bodies.size());
    nearest_search.any = nearest_search.count > 0;
    Statistics& statistics = nearest_search.statistics;
    statistics.pairs = nearest_search.count;
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return nearest_search;
}

const Overlaps& WorldCalls::find(const World& world, const OverlapQuery& query, std::stop_token stop) {
    run_with_retry(overlaps, std::move(stop), [&](bool) { search(world, query, nullptr); });
    overlaps.statistics.pairs = overlaps.count;
    return overlaps;
}

const Overlaps& WorldCalls::combine(const World& world, const OverlapQuery& query, std::span<const Overlaps> parts,
                                    std::stop_token stop) {
    for (const Overlaps& part : parts)
        if (&part == &overlaps) refuse("take the result of a part out of the detector before it combines the parts");
    run_with_retry(overlaps, std::move(stop), [&](bool) {
        check_query_options(query, world);
        const PairsOfParts pairs(parts, world, query, meter);
        overlap_search.find(*backend, host_backend(), worlds, world, query, overlaps, nullptr, &pairs);
    });
    overlaps.statistics.pairs = overlaps.count;
    return overlaps;
}

void WorldCalls::search(const World& world, const OverlapQuery& query, const OverlapBlocks* blocks) {
    check_query_options(query, world);
    check_bodies_have_triangles(world, query.filter, false, "only triangles enclose a volume");
    const PosedOnHost there(*backend, world);
    if (working != Backend::reference)
        return overlap_search.find(*backend, host_backend(), worlds, there.world(), query, overlaps, blocks);
    find_reference_overlaps(there.world(), query);
    if (!blocks) return;
    Overlaps block = metered_overlaps(&meter);
    deliver_in_blocks(overlaps, *blocks, block, cancellation);
}

void WorldCalls::find_reference_overlaps(const World& world, const OverlapQuery& query) {
    find_overlaps_by_brute_force(world, query, meter, cancellation, overlaps);
    if (query.depth_tolerance == 0) return;
    // Many bounds are valid, and all backends find the same ones.
    Overlaps bounds = metered_overlaps(&meter);
    OverlapQuery only_bounds{
        .output = query.output, .min_volume = query.min_volume, .open = query.open, .weld = query.weld};
    only_bounds.self_overlaps = query.self_overlaps;
    only_bounds.depth_tolerance = query.depth_tolerance;
    only_bounds.filter = query.filter;
    overlap_search.find(*backend, *backend, worlds, world, only_bounds, bounds);
    overlaps.depth_reached.swap_elements(bounds.depth_reached);
    overlaps.depth_bound.swap_elements(bounds.depth_bound);
}

Statistics WorldCalls::stream(const World& world, const OverlapQuery& query, Sink<OverlapQuery> take,
                              std::int64_t block_rows, std::stop_token stop) {
    Stopwatch watch;
    if (meter.limit > 0) free_caches();
    const OverlapBlocks blocks{block_rows, take};
    const auto stream = [&] {
        check_blocks(block_rows);
        check_in_blocks(query);
        search(world, query, &blocks);
    };
    run(std::move(stop), stream, [](std::int64_t) { return false; });
    Statistics statistics = overlaps.statistics;
    statistics.pairs = overlaps.count;
    clear(overlaps);
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return statistics;
}

template <class Query>
const typename Query::Result& WorldCalls::find_features(const World& world, const Query& query, bool bodies,
                                                        std::stop_token stop) {
    auto& result = result_of(query);
    return run_with_retry(result, std::move(stop), [&](bool low_memory) {
        check_query_options(query, bodies);
        if (!bodies) check_groups(query.filter, world.shapes[0].triangles.rows, !world.shapes[0].groups.empty());
        features.find(*backend, PosedOnHost(*backend, world).world(), query, bodies, low_memory, result);
    });
}

// A call that has delivered blocks cannot be retried. So under a memory limit it frees all cached memory first, and
// then uses as little as possible.
template <class Query>
Statistics WorldCalls::stream_features(const World& world, const Query& query, bool bodies,
                                       const FeatureBlocks<typename Query::Result>& blocks, std::stop_token stop) {
    Stopwatch watch;
    if (meter.limit > 0) free_caches();
    auto& result = result_of(query);
    const auto stream = [&] {
        check_blocks(blocks.most);
        check_query_options(query, bodies);
        if (!bodies) check_groups(query.filter, world.shapes[0].triangles.rows, !world.shapes[0].groups.empty());
        check_in_blocks(query);
        const PosedOnHost there(*backend, world);
        features.stream(*backend, there.world(), query, bodies, meter.limit > 0, blocks, result);
    };
    run(std::move(stop), stream, [](std::int64_t) { return false; });
    Statistics statistics = result.statistics;
    clear(result);
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return statistics;
}

template const Impacts& WorldCalls::find_features(const World&, const ImpactQuery&, bool, std::stop_token);
template const Proximities& WorldCalls::find_features(const World&, const ProximityQuery&, bool, std::stop_token);
template const Candidates& WorldCalls::find_features(const World&, const CandidateQuery&, bool, std::stop_token);
template Statistics WorldCalls::stream_features(const World&, const ImpactQuery&, bool, const FeatureBlocks<Impacts>&,
                                                std::stop_token);
template Statistics WorldCalls::stream_features(const World&, const ProximityQuery&, bool,
                                                const FeatureBlocks<Proximities>&, std::stop_token);
template Statistics WorldCalls::stream_features(const World&, const CandidateQuery&, bool,
                                                const FeatureBlocks<Candidates>&, std::stop_token);

}  // namespace crumple
