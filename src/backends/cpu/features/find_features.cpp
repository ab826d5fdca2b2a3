#include "backends/cpu/features/find_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/stopwatch.h"
#include "filters/candidates/candidate_inflation.h"
#include "filters/features/thresholds.h"
#include "geometry/normaliser.h"

namespace crumple::cpu {
namespace {

constexpr std::int64_t features_at_once = 4096;

// Sorts rows: by first feature in a counting sort on this thread, then the rows of each first feature by the second one
// on all threads.
void write_rows(std::span<const FeatureRows* const> found, std::int64_t firsts, const Call& call,
                FeatureBuffers& buffers, FeatureRows& rows) {
    Array<std::int64_t>& place = buffers.place;
    place.assign(static_cast<std::size_t>(firsts) + 2, 0);
    std::int64_t* next = place.data() + 1;
    std::size_t all = 0;
    for (const auto* list : found) {
        all += list->size();
        for_each_checked(list->size(), call.cancellation, [&](std::size_t i) { ++next[list->pairs[i].a + 1]; });
    }
    for (std::int64_t i = 0; i < firsts; ++i) next[i + 1] += next[i];
    buffers.placed.resize_discard(all);
    for (const auto* list : found)
        for_each_checked(list->size(), call.cancellation,
                         [&](std::size_t i) { buffers.placed[next[list->pairs[i].a]++] = (*list)[i]; });
    rows.resize_discard(all);
    call.workers.parallel_for(
        static_cast<std::size_t>((firsts + features_at_once - 1) / features_at_once), [&](std::size_t c, std::size_t) {
            const std::int64_t begin = static_cast<std::int64_t>(c) * features_at_once,
                               end = std::min(firsts, begin + features_at_once);
            FeatureHit* hits = buffers.placed.data();
            for (std::int64_t i = begin; i < end; ++i)
                std::sort(hits + place[i], hits + place[i + 1],
                          [](const FeatureHit& a, const FeatureHit& b) { return a.pair.b < b.pair.b; });
            for (std::int64_t i = place[begin]; i < place[end]; ++i) rows.set(static_cast<std::size_t>(i), hits[i]);
        });
}

FirstImpact first_of(std::span<const FeatureRows* const> found, FeatureKind kind, FirstImpact first) {
    for (const FeatureRows* list : found)
        for (std::size_t i = 0; i < list->size(); ++i) {
            const FeatureHit hit = (*list)[i];
            const bool sooner =
                hit.value < first.toi || (hit.value == first.toi && kind == first.kind && hit.pair < first.pair);
            if (!first.found || sooner) first = {true, kind, hit.pair, {}, hit.value, hit.flag != 0};
        }
    return first;
}

template <int moments>
void write(const Call& call, const FeatureRequest& query, const FeatureLeaves<moments>& leaves, FeatureBuffers& buffers,
           FeatureResult& result) {
    result.any = leaves.any();
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto kind = static_cast<FeatureKind>(k);
        if (query.criterion == Criterion::impact && query.extent != Extent::any)
            result.first = first_of(leaves.found(kind), kind, result.first);
        if (query.extent != Extent::all || !query.lists(candidate_kind(kind))) continue;
        const std::int64_t firsts = count_of(query.features, types_of(kind).first);
        write_rows(leaves.found(kind), firsts, call, buffers, result.rows[kind]);
    }
}
void write(const Call& call, const FeatureRequest& query, const CandidateLeaves&, FeatureBuffers& buffers,
           FeatureResult& result) {
    write_candidates(call, query, buffers.candidates, result);
}

void search(const Call& call, const FeatureRequest& query, CandidateLeaves& leaves) {
    search_candidates(call, query, leaves);
}
template <int moments>
void search(const Call& call, const FeatureRequest&, FeatureLeaves<moments>&) {
    search(call);
}

/// Calls work(leaves) with the LeafQuery of `buffers` that serves the request, after passing the request to it.
template <class Work>
void with_leaves(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, Work work) {
    const auto ask = [&](auto& leaves) {
        leaves.ask(query, 2 * call.inflation.half, query.radii.empty() ? nullptr : buffers.vertex_radius.data());
        work(leaves);
    };
    if (query.criterion == Criterion::candidate) {
        buffers.candidates.leaves.ask(query);
        work(buffers.candidates.leaves);
    } else if (call.scene.moving) {
        ask(buffers.moving);
    } else {
        ask(buffers.at_rest);
    }
}

}  // namespace

Inflation inflation_of(const PreparedScene& scene, const FeatureRequest& query) {
    const Normaliser normaliser(scene.low, scene.high);
    if (query.criterion == Criterion::candidate) return inflation_of_candidates(normaliser, query.distance);
    return crumple::inflation_of(normaliser, query.distance, query.share);
}

Inflation inflation_of_radii(const PreparedScene& scene, std::span<const double> radii, Workers& workers,
                             FeatureBuffers& buffers) {
    const Normaliser normaliser(scene.low, scene.high);
    Array<float>&vertex = buffers.vertex_radius, &triangle = buffers.triangle_radius;
    vertex.resize_discard(radii.size());
    triangle.resize_discard(static_cast<std::size_t>(scene.triangle_count()));
    const auto for_each = [&](std::size_t n, auto visit) {
        constexpr auto some = static_cast<std::size_t>(features_at_once);
        workers.parallel_for((n + some - 1) / some, [&](std::size_t c, std::size_t) {
            for (std::size_t i = c * some; i < std::min(n, (c + 1) * some); ++i) visit(i);
        });
    };
    for_each(vertex.size(), [&](std::size_t v) { vertex[v] = radius_of(normaliser, radii[v]); });
    for_each(triangle.size(), [&](std::size_t t) {
        const std::int32_t* c = scene.corners + 3 * t;
        triangle[t] = std::max(vertex[c[0]], std::max(vertex[c[1]], vertex[c[2]]));
    });
    const auto largest = std::max_element(triangle.begin(), triangle.end());
    return {largest == triangle.end() ? 0 : *largest, 0, false, triangle.data()};
}

LeafQuery& leaves_of(const PreparedScene& scene, const FeatureRequest& query, FeatureBuffers& buffers) {
    if (query.criterion == Criterion::candidate) return buffers.candidates.leaves;
    if (scene.moving) return buffers.moving;
    return buffers.at_rest;
}

void find(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureResult& result) {
    with_leaves(call, query, buffers, [&](auto& leaves) {
        measure(call);
        search(call, query, leaves);
        Stopwatch watch;
        write(call, query, leaves, buffers, result);
        call.statistics[Stage::output] += watch.lap();
    });
}

void stream(Call call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureStream& to) {
    std::int64_t units = 0;
    call.units = &units;
    with_leaves(call, query, buffers, [&](auto& leaves) {
        leaves.deliver_to(to);
        measure(call);
        search(call, query, leaves);
    });
}

}  // namespace crumple::cpu
