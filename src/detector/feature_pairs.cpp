// Exact decisions about pairs of features that the caller lists (crumple/feature_pairs.h), without a search. Several
// threads share the pairs; a task has `pairs_of_task` of them.

#include "crumple/feature_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "backends/cpu/parallel.h"
#include "base/cancellation.h"
#include "base/float_environment.h"
#include "crumple/error.h"
#include "exact/impact/decide_impact.h"
#include "exact/impact/decide_min_distance.h"
#include "exact/proximity/decide_distance.h"
#include "filters/features/feature_points.h"
#include "queries/checks.h"
#include "scene/outline.h"
#include "scene/prepared_scene.h"

namespace crumple {
namespace {

constexpr std::size_t pairs_of_task = 256;

// Points of the pairs, read from the caller's array.
class PairPoints {
   public:
    PairPoints(FeatureKinds kinds, const VertexView& view, const char* name)
        : points_(points_of(kinds)),
          rows_(view.rows),
          reader_{static_cast<const std::byte*>(view.data), view.row_stride, view.column_stride,
                  view.type == ScalarType::float32} {
        if (const char* fault = fault_of(view))
            throw Error(ErrorCode::invalid_argument, std::string("rows of ") + name + fault, Element::option);
        if (rows_ >= 0 && rows_ % static_cast<std::int64_t>(points_) == 0) return;
        throw Error(ErrorCode::invalid_argument,
                    std::string(name) + " must have " + std::to_string(points_) + " rows per pair, and " +
                        std::to_string(rows_) + " is not a multiple of " + std::to_string(points_),
                    Element::option);
    }

    std::size_t pairs() const { return static_cast<std::size_t>(rows_) / points_; }

    Vec3d operator()(std::size_t pair, std::size_t point) const {
        return reader_(static_cast<std::int64_t>(pair * points_ + point));
    }

    void check_finite(const char* name) const {
        for (std::size_t i = 0; i < pairs() * points_; ++i) {
            const Vec3d p = reader_(static_cast<std::int64_t>(i));
            if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
            throw Error(ErrorCode::not_finite, std::string(name) + ": point " + std::to_string(i % points_) +
                                                   " of pair " + std::to_string(i / points_) + " is not finite");
        }
    }

   private:
    std::size_t points_;
    std::int64_t rows_;
    VertexReader reader_;
};

template <class Decide>
void for_each_pair(std::size_t pairs, int threads, std::stop_token stop, Decide decide) {
    Cancellation cancellation;
    cancellation.begin(std::move(stop));
    cancellation.check();
    Options options;
    options.threads = pairs <= pairs_of_task ? 1 : threads;
    cpu::Workers workers(options, cancellation);
    workers.run([&] {
        workers.parallel_for((pairs + pairs_of_task - 1) / pairs_of_task, [&](std::size_t task, std::size_t) {
            const std::size_t first = task * pairs_of_task, last = std::min(pairs, first + pairs_of_task);
            for (std::size_t pair = first; pair < last; ++pair) decide(pair);
        });
    });
}

FeatureKinds checked(FeatureKind kind) {
    check(static_cast<int>(kind) < feature_kinds, "kind must be a value of FeatureKind");
    return kinds_of(kind);
}

void check_threads(int threads) {
    Options options;
    options.threads = threads;
    check_options(options);
}

Impact decide_impact(FeatureKinds kinds, const std::array<MovingPoint, 4>& p, const PairImpactQuery& query) {
    const MinDistance separation{query.min_distance, query.min_distance_share, query.approaching_only};
    const bool vertex_face = kinds == FeatureKinds::vertex_face;
    if (!separation.contact_only() || (!vertex_face && kinds != FeatureKinds::edge_edge)) {
        MinDistanceCounts counts;
        return decide_min_distance(kinds, p, separation, counts);
    }
    ImpactCounts counts;
    const Impact impact = vertex_face ? vertex_face_impact(p[0], p[1], p[2], p[3], counts)
                                      : edge_edge_impact(p[0], p[1], p[2], p[3], counts);
    return impact.start && separation.approaching_only ? Impact{} : impact;  // at distance 0 they cannot approach
}

}  // namespace

PairImpacts pair_impacts(FeatureKind kind, const VertexView& start, const VertexView& end, const PairImpactQuery& query,
                         std::stop_token stop) {
    const FloatEnvironment environment;
    const FeatureKinds kinds = checked(kind);
    check_threads(query.threads);
    ImpactQuery as_motion;
    as_motion.min_distance = query.min_distance;
    as_motion.min_distance_share = query.min_distance_share;
    as_motion.approaching_only = query.approaching_only;
    check_query_options(as_motion, false);
    const PairPoints from(kinds, start, "start"), to(kinds, end, "end");
    if (from.pairs() != to.pairs())
        throw Error(ErrorCode::invalid_argument,
                    "end must have as many pairs as start, " + std::to_string(from.pairs()) + ", not " +
                        std::to_string(to.pairs()),
                    Element::option);
    from.check_finite("start");
    to.check_finite("end");

    PairImpacts answer;
    answer.hit.resize_discard(from.pairs());
    answer.toi.resize_discard(from.pairs());
    answer.start.resize_discard(from.pairs());
    for_each_pair(from.pairs(), query.threads, std::move(stop), [&](std::size_t pair) {
        std::array<MovingPoint, 4> points{};
        for (std::size_t i = 0; i < points_of(kinds); ++i) points[i] = {from(pair, i), to(pair, i)};
        const Impact impact = decide_impact(kinds, points, query);
        answer.hit[pair] = impact.meets;
        answer.toi[pair] = impact.meets ? impact.toi : std::numeric_limits<double>::infinity();
        answer.start[pair] = impact.start;
    });
    return answer;
}

PairDistances pair_distances(FeatureKind kind, const VertexView& view, int threads, std::stop_token stop) {
    const FloatEnvironment environment;
    const FeatureKinds kinds = checked(kind);
    check_threads(threads);
    const PairPoints points(kinds, view, "points");
    points.check_finite("points");

    PairDistances answer;
    answer.squared_distance.resize_discard(points.pairs());
    answer.touching.resize_discard(points.pairs());
    answer.type.resize_discard(points.pairs());
    answer.at.resize_discard(points.pairs());
    for_each_pair(points.pairs(), threads, std::move(stop), [&](std::size_t pair) {
        Features features{kinds, {}};
        for (std::size_t i = 0; i < points_of(kinds); ++i) features.point[i] = points(pair, i);
        DistanceCounts counts;
        Distance distance(features, counts);
        answer.squared_distance[pair] = distance.squared();
        answer.touching[pair] = distance.touching();
        const ClosestPoints closest = distance.closest();
        answer.type[pair] = closest.type;
        answer.at[pair] = closest.at;
    });
    return answer;
}

}  // namespace crumple
