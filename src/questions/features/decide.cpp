#include "questions/features/decide.h"

#include "questions/motion/decide_impact.h"
#include "questions/motion/decide_separation.h"
#include "questions/near/decide_distance.h"

namespace crumple {
namespace {

FeatureDecision separated_impact(FeatureKind kind, const FeaturePoints& p, const Separation& separation,
                                 FeatureCounts& counts) {
    SeparationCounts by;
    const Impact impact = decide_separation(kinds_of(kind), p, separation, by);
    counts.rational += by.rational;
    return {impact.meets, impact.toi, impact.start};
}

// Of vertices with edges and vertices next to none touch, and to tell how far they stay apart is quick.
FeatureDecision impact(FeatureKind kind, const FeaturePoints& p, FeatureCounts& counts) {
    if (kind == FeatureKind::vertex_edge || kind == FeatureKind::vertex_vertex)
        return separated_impact(kind, p, {}, counts);
    ImpactCounts by;
    const Impact impact = kind == FeatureKind::vertex_face ? vertex_face_impact(p[0], p[1], p[2], p[3], by)
                                                           : edge_edge_impact(p[0], p[1], p[2], p[3], by);
    counts.rational += by.exact;
    return {impact.meets, impact.toi, impact.start};
}

FeatureDecision nearness(FeatureKind kind, const FeaturePoints& p, const Reach& reach, FeatureCounts& counts) {
    DistanceCounts by;
    Distance distance(at_start(kind, p), by);
    FeatureDecision decision;
    if (distance.within(reach)) decision = {true, distance.squared(), distance.touching()};
    counts.rational += by.rational;
    return decision;
}

}  // namespace

FeatureDecision decide(FeatureKind kind, const FeaturePoints& points, const FeatureQuery& query,
                       FeatureCounts& counts) {
    ++counts.tests;
    if (!query.motion) return nearness(kind, points, {query.distance, 0, query.strict}, counts);
    if (query.distance == 0 && query.share == 0) return impact(kind, points, counts);
    return separated_impact(kind, points, {query.distance, query.share}, counts);
}

}  // namespace crumple
