#include "results/near_details.h"

#include <algorithm>
#include <limits>

#include "exact/proximity/decide_distance.h"
#include "filters/features/feature_points.h"

namespace crumple {
namespace {

constexpr std::size_t pairs_of_task = 1024;

template <class Task>
void for_each_chunk(std::size_t n, ParallelFor& workers, Task task) {
    workers.parallel_for((n + pairs_of_task - 1) / pairs_of_task,
                         [&](std::size_t c) { task(c * pairs_of_task, std::min(n, (c + 1) * pairs_of_task)); });
}

Features features_at_start(const PreparedScene& scene, const SceneFeatures& features, FeatureKind kind,
                           const Pair& pair) {
    const auto of = [&](const std::int32_t(&vertex)[4]) { return at_start(kind, points_of(scene, vertex)); };
    if (kind == FeatureKind::edge_edge) {
        const Edge e = features.edges()[pair.a], f = features.edges()[pair.b];
        return of({e.a, e.b, f.a, f.b});
    }
    const std::int32_t v = features.vertex_of(pair.a);
    if (kind == FeatureKind::vertex_face) {
        const std::int32_t* c = scene.corners + 3 * std::int64_t{pair.b};
        return of({v, c[0], c[1], c[2]});
    }
    if (kind == FeatureKind::vertex_edge) {
        const Edge e = features.edges()[pair.b];
        return of({v, e.a, e.b, e.b});
    }
    const std::int32_t w = features.vertex_of(pair.b);
    return of({v, w, w, w});
}

// Lowers the value of each feature to the least value of its pairs.
void lower(const Array<Pair>& pairs, const Array<double>& value, Array<double>& of_first, Array<double>& of_second,
           Cancellation& cancellation) {
    for_each_checked(pairs.size(), cancellation, [&](std::size_t i) {
        of_first[pairs[i].a] = std::min(of_first[pairs[i].a], value[i]);
        of_second[pairs[i].b] = std::min(of_second[pairs[i].b], value[i]);
    });
}

}  // namespace

void append_closest(const PreparedScene& scene, const SceneFeatures& features, FeatureKind kind,
                    const Array<Pair>& pairs, ParallelFor* workers, ProximityList& list) {
    const std::size_t first = list.type.size();
    list.type.resize(first + pairs.size());
    list.at.resize(first + pairs.size());
    const auto find = [&](std::size_t begin, std::size_t end) {
        DistanceCounts counts;
        for (std::size_t i = begin; i < end; ++i) {
            const ClosestPoints closest =
                Distance(features_at_start(scene, features, kind, pairs[i]), counts).closest();
            list.type[first + i] = closest.type;
            list.at[first + i] = closest.at;
        }
    };
    if (workers)
        for_each_chunk(pairs.size(), *workers, find);
    else
        find(0, pairs.size());
}

// Rounding is monotonic: the least distance of a feature is that of a pair whose rounded squared distance is least.
// Only the distances of such pairs are computed.
void add_least_distances(const PreparedScene& scene, const SceneFeatures& features, ParallelFor& workers,
                         Cancellation& cancellation, Proximities& answer) {
    constexpr double none = std::numeric_limits<double>::infinity();
    const auto of = [&](FeatureKind kind, Array<double>& firsts, Array<double>& seconds) {
        const ProximityList& list = answer[kind];
        Array<double> first_square, second_square, distance;
        first_square.assign(firsts.size(), none);
        second_square.assign(seconds.size(), none);
        lower(list.pairs, list.squared_distance, first_square, second_square, cancellation);
        distance.resize_discard(list.pairs.size());
        for_each_chunk(list.pairs.size(), workers, [&](std::size_t begin, std::size_t end) {
            DistanceCounts counts;
            for (std::size_t i = begin; i < end; ++i) {
                const Pair pair = list.pairs[i];
                const double square = list.squared_distance[i];
                distance[i] = none;
                if (square > first_square[pair.a] && square > second_square[pair.b]) continue;
                distance[i] = Distance(features_at_start(scene, features, kind, pair), counts).rounded_down();
            }
        });
        lower(list.pairs, distance, firsts, seconds, cancellation);
    };
    answer.vertex_distance.assign(static_cast<std::size_t>(features.points()), none);
    answer.face_distance.assign(static_cast<std::size_t>(features.faces()), none);
    answer.edge_distance.assign(features.edges().size(), none);
    of(FeatureKind::vertex_face, answer.vertex_distance, answer.face_distance);
    of(FeatureKind::edge_edge, answer.edge_distance, answer.edge_distance);
    of(FeatureKind::vertex_edge, answer.vertex_distance, answer.edge_distance);
    of(FeatureKind::vertex_vertex, answer.vertex_distance, answer.vertex_distance);
}

void add_details(const PreparedScene& scene, const SceneFeatures& features, const ProximityQuery& query,
                 ParallelFor& workers, Cancellation& cancellation, Proximities& result) {
    for (std::size_t k = 0; query.closest && k < feature_kinds; ++k)
        append_closest(scene, features, static_cast<FeatureKind>(k), result.lists[k].pairs, &workers, result.lists[k]);
    if (query.least) add_least_distances(scene, features, workers, cancellation, result);
}

}  // namespace crumple
