#include "questions/features/decide.h"

#include "questions/motion/rational_impact.h"

namespace crumple {

FeatureDecision decide(FeatureKind kind, const FeaturePoints& p, const FeatureQuery&, FeatureCounts& counts) {
    ++counts.tests;
    ++counts.rational;
    const Impact impact =
        kind == FeatureKind::vertex_face ? vertex_face(p[0], p[1], p[2], p[3]) : edge_edge(p[0], p[1], p[2], p[3]);
    return {impact.meets, impact.toi, impact.start};
}

}  // namespace crumple
