#include "backends/cpu/features/find_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/stopwatch.h"
#include "filters/features/thresholds.h"
#include "geometry/normaliser.h"

namespace crumple::cpu {
namespace {

constexpr std::int64_t features_at_once = 4096;

// A counting sort by first feature, then those of each by the second, on all threads.
void write_rows(std::span<const Array<FeatureHit>* const> found, std::int64_t firsts, Workers& workers,
                FeatureBuffers& buffers, FeatureRows& rows) {
    Array<std::int64_t>& place = buffers.place;
    place.assign(static_cast<std::size_t>(firsts) + 2, 0);
    std::int64_t* next = place.data() + 1;
    std::size_t all = 0;
    for (const auto* list : found) {
        all += list->size();
        for (const FeatureHit& hit : *list) ++next[hit.pair.a + 1];
    }
    for (std::int64_t i = 0; i < firsts; ++i) next[i + 1] += next[i];
    buffers.placed.resize_discard(all);
    for (const auto* list : found)
        for (const FeatureHit& hit : *list) buffers.placed[next[hit.pair.a]++] = hit;
    rows.pairs.resize_discard(all);
    rows.value.resize_discard(all);
    rows.flag.resize_discard(all);
    workers.parallel_for(
        static_cast<std::size_t>((firsts + features_at_once - 1) / features_at_once), [&](std::size_t c, std::size_t) {
            const std::int64_t begin = static_cast<std::int64_t>(c) * features_at_once,
                               end = std::min(firsts, begin + features_at_once);
            FeatureHit* hits = buffers.placed.data();
            for (std::int64_t i = begin; i < end; ++i)
                std::sort(hits + place[i], hits + place[i + 1],
                          [](const FeatureHit& a, const FeatureHit& b) { return a.pair.b < b.pair.b; });
            for (std::int64_t i = place[begin]; i < place[end]; ++i) {
                rows.pairs[i] = hits[i].pair;
                rows.value[i] = hits[i].value;
                rows.flag[i] = hits[i].flag;
            }
        });
}

FirstImpact first_of(std::span<const Array<FeatureHit>* const> found, FeatureKind kind, FirstImpact first) {
    for (const auto* list : found)
        for (const FeatureHit& hit : *list) {
            const bool sooner =
                hit.value < first.toi || (hit.value == first.toi && kind == first.kind && hit.pair < first.pair);
            if (!first.found || sooner) first = {true, kind, hit.pair, {}, hit.value, hit.flag != 0};
        }
    return first;
}

template <int moments>
void find(const Call& call, const FeatureRequest& query, FeatureLeaves<moments>& leaves, FeatureBuffers& buffers,
          FeatureAnswer& answer) {
    measure(call);
    search(call);
    Stopwatch watch;
    answer.any = leaves.any();
    constexpr FeatureKind kinds[feature_kinds] = {FeatureKind::vertex_face, FeatureKind::edge_edge,
                                                  FeatureKind::vertex_edge, FeatureKind::vertex_vertex};
    if (query.motion && query.extent != Extent::any)
        for (const FeatureKind kind : kinds) answer.first = first_of(leaves.found(kind), kind, answer.first);
    if (query.extent == Extent::all)
        for (const FeatureKind kind : kinds) {
            const std::int64_t firsts = count_of(query.features, types_of(kind).first);
            write_rows(leaves.found(kind), firsts, call.workers, buffers, answer.rows[static_cast<std::size_t>(kind)]);
        }
    call.statistics[Stage::output] += watch.lap();
}

}  // namespace

Inflation inflation_of(const PreparedScene& scene, const FeatureRequest& query) {
    return crumple::inflation_of(Normaliser(scene.low, scene.high), query.distance, query.share);
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

void find(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureAnswer& answer) {
    with_leaves(call, query, buffers, [&](auto& leaves) { find(call, query, leaves, buffers, answer); });
}

void stream(Call call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureStream& to) {
    std::int64_t units = 0;
    call.units = &units;
    with_leaves(call, query, buffers, [&](auto& leaves) {
        leaves.deliver_to(to);
        measure(call);
        search(call);
    });
}

}  // namespace crumple::cpu
