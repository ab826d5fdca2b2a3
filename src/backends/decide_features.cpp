#include "backends/decide_features.h"

#include <algorithm>

#include "exact/impact/decide_impact.h"
#include "exact/impact/decide_min_distance.h"
#include "exact/proximity/decide_distance.h"

namespace crumple {
namespace {

FeatureDecision min_distance_impact(FeatureKind kind, const FeaturePoints& p, const MinDistance& min_distance,
                                    FeatureCounts& counts) {
    MinDistanceCounts by;
    const Impact impact = decide_min_distance(kinds_of(kind), p, min_distance, by);
    counts.rational += by.rational;
    return {impact.meets, impact.toi, impact.start};
}

// Pairs of a vertex and an edge, or of two vertices, are decided as with a minimum distance even for contact, with a
// minimum distance of 0: they rarely touch, and a lower bound on their distance is cheap.
FeatureDecision impact(FeatureKind kind, const FeaturePoints& p, const FeatureRequest& query, FeatureCounts& counts) {
    const MinDistance min_distance{query.distance, query.share, query.approaching_only};
    if (!min_distance.contact_only() || kind == FeatureKind::vertex_edge || kind == FeatureKind::vertex_vertex)
        return min_distance_impact(kind, p, min_distance, counts);
    ImpactCounts by;
    const auto decide = kind == FeatureKind::vertex_face ? vertex_face_impact : edge_edge_impact;
    const Impact impact = decide(p[0], p[1], p[2], p[3], by, Filtered::yes);
    counts.rational += by.exact;
    if (impact.start && query.approaching_only) return {};  // features at distance 0 cannot come nearer
    return {impact.meets, impact.toi, impact.start};
}

// Returns how many of the four vertices belong to the first feature.
std::size_t split_of(FeatureKind kind) { return kind == FeatureKind::edge_edge ? 2 : 1; }

DistanceLimit distance_limit_of(FeatureKind kind, const std::int32_t (&vertex)[4], const FeatureRequest& query) {
    return distance_limit_of(kind, vertex, query.radii.empty() ? nullptr : query.radii.data(), query.distance,
                             query.strict);
}

bool close_in_rest_shape(FeatureKind kind, const std::array<Vec3d, 4>& points, double radius, DistanceCounts& by) {
    return Distance({kinds_of(kind), points}, by).within({radius, 0});
}
bool close_in_rest_shape(FeatureKind kind, const std::int32_t (&vertex)[4], const RestShape& rest, DistanceCounts& by) {
    if (!rest.knows(vertex[0], vertex[3])) return false;
    const std::array points{rest.position(vertex[0]), rest.position(vertex[1]), rest.position(vertex[2]),
                            rest.position(vertex[3])};
    return close_in_rest_shape(kind, points, rest.radius, by);
}

/// Decision of a proximity: first whether two features are near, then their distance.
class Nearness {
   public:
    Nearness(FeatureKind kind, const FeaturePoints& p) : features_(at_start(kind, p)), distance_(features_, by_) {}

    bool near(FeatureKind kind, const std::int32_t (&vertex)[4], const FeatureRequest& query) {
        return distance_.within(distance_limit_of(kind, vertex, query)) &&
               !(query.rest && close_in_rest_shape(kind, vertex, *query.rest, by_));
    }
    bool near(const FeaturesToDecide& pair, double rest_radius) {
        return distance_.within(pair.reach) &&
               !(pair.has_rest && close_in_rest_shape(pair.kind, pair.rest, rest_radius, by_));
    }
    FeatureDecision measured() { return {true, distance_.squared(), distance_.touching()}; }
    void add_to(cpu::GuessBatch& batch) const { batch.add(features_, distance_.guess()); }
    std::int64_t rational() const { return by_.rational; }

   private:
    DistanceCounts by_;
    Features features_;
    Distance distance_;
};

FeatureDecision nearness(FeatureKind kind, const FeaturePoints& p, const std::int32_t (&vertex)[4],
                         const FeatureRequest& query, FeatureCounts& counts) {
    Nearness pair(kind, p);
    FeatureDecision decision;
    if (pair.near(kind, vertex, query)) decision = pair.measured();
    counts.rational += pair.rational();
    return decision;
}

}  // namespace

FeatureDecision decide(FeatureKind kind, const PreparedScene& scene, const std::int32_t (&vertex)[4],
                       const FeatureRequest& query, FeatureCounts& counts) {
    ++counts.tests;
    const FeaturePoints points = points_of(scene, vertex);
    if (query.criterion != Criterion::impact) return nearness(kind, points, vertex, query, counts);
    return impact(kind, points, query, counts);
}

bool surely_later(FeatureKind kind, const PreparedScene& scene, const std::int32_t (&vertex)[4],
                  const FeatureRequest& query, double time) {
    return surely_later(kinds_of(kind), points_of(scene, vertex), {query.distance, query.share}, time);
}

FeatureDecision decide(const FeaturesToDecide& pair, const FeatureRequest& query, FeatureCounts& counts) {
    ++counts.tests;
    if (query.criterion == Criterion::impact) return impact(pair.kind, pair.points, query, counts);
    Nearness near(pair.kind, pair.points);
    FeatureDecision decision;
    if (near.near(pair, query.rest ? query.rest->radius : 0)) decision = near.measured();
    counts.rational += near.rational();
    return decision;
}

std::optional<FeatureDecision> decide_or_add(FeatureKind kind, const PreparedScene& scene,
                                             const std::int32_t (&vertex)[4], const FeatureRequest& query,
                                             FeatureCounts& counts, cpu::GuessBatch& batch) {
    ++counts.tests;
    Nearness pair(kind, points_of(scene, vertex));
    std::optional<FeatureDecision> decision = FeatureDecision();
    if (pair.near(kind, vertex, query)) {
        if (pair.rational() > 0) {
            decision = pair.measured();
        } else {
            pair.add_to(batch);
            decision.reset();
        }
    }
    counts.rational += pair.rational();
    return decision;
}

bool are_adjacent(FeatureKind kind, const std::int32_t (&vertex)[4], const FeatureRequest& query) {
    for (std::size_t i = 0; i < split_of(kind); ++i)
        for (std::size_t k = split_of(kind); k < 4; ++k)
            if (query.rings->joined(query.features.name(vertex[i]), query.features.name(vertex[k]))) return true;
    return false;
}

}  // namespace crumple
