#include "exact/impact/decide_separation.h"

#include "exact/impact/quick_separation.h"
#include "exact/impact/rational_impact.h"
#include "exact/impact/rational_separation.h"

namespace crumple {
namespace {

QuickImpact quick(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const Separation& separation) {
    switch (kinds) {
        case FeatureKinds::vertex_face:
            return quick_separation<FeatureKinds::vertex_face>(points, separation);
        case FeatureKinds::edge_edge:
            return quick_separation<FeatureKinds::edge_edge>(points, separation);
        case FeatureKinds::vertex_edge:
            return quick_separation<FeatureKinds::vertex_edge>(points, separation);
        case FeatureKinds::vertex_vertex:
            break;
    }
    return quick_separation<FeatureKinds::vertex_vertex>(points, separation);
}

Impact rational(FeatureKinds kinds, const std::array<MovingPoint, 4>& points) {
    const auto& [p, q, r, s] = points;
    switch (kinds) {
        case FeatureKinds::vertex_face:
            return vertex_face(p, q, r, s);
        case FeatureKinds::edge_edge:
            return edge_edge(p, q, r, s);
        case FeatureKinds::vertex_edge:
            return vertex_edge(p, q, r);
        case FeatureKinds::vertex_vertex:
            break;
    }
    return vertex_vertex(p, q);
}

Impact rational(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const Separation& separation) {
    const auto& [p, q, r, s] = points;
    if (separation.distance == 0 && separation.share == 0) return rational(kinds, points);
    switch (kinds) {
        case FeatureKinds::vertex_face:
            return vertex_face(p, q, r, s, separation);
        case FeatureKinds::edge_edge:
            return edge_edge(p, q, r, s, separation);
        case FeatureKinds::vertex_edge:
            return vertex_edge(p, q, r, separation);
        case FeatureKinds::vertex_vertex:
            break;
    }
    return vertex_vertex(p, q, separation);
}

}  // namespace

Impact decide_separation(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const Separation& separation,
                         SeparationCounts& counts) {
    const QuickImpact found = quick(kinds, points, separation);
    if (found.verdict != Certainty::unknown) return {found.verdict == Certainty::meets, found.toi, found.start};
    ++counts.rational;
    return rational(kinds, points, separation);
}

}  // namespace crumple
