#include "exact/impact/decide_min_distance.h"

#include "exact/impact/exact_impact.h"
#include "exact/impact/exact_min_distance.h"
#include "exact/impact/filtered_closing.h"
#include "exact/impact/filtered_min_distance.h"

namespace crumple {
namespace {

template <FeatureKinds kinds>
FilteredImpact quick(const std::array<MovingPoint, 4>& points, const MinDistance& separation) {
    const FilteredImpact found = filtered_min_distance<kinds>(points, separation);
    return separation.approaching_only && found.start ? filtered_closing<kinds>(points) : found;
}

FilteredImpact quick(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const MinDistance& separation) {
    switch (kinds) {
        case FeatureKinds::vertex_face:
            return quick<FeatureKinds::vertex_face>(points, separation);
        case FeatureKinds::edge_edge:
            return quick<FeatureKinds::edge_edge>(points, separation);
        case FeatureKinds::vertex_edge:
            return quick<FeatureKinds::vertex_edge>(points, separation);
        case FeatureKinds::vertex_vertex:
            break;
    }
    return quick<FeatureKinds::vertex_vertex>(points, separation);
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

Impact rational(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const MinDistance& separation) {
    const auto& [p, q, r, s] = points;
    if (separation.contact_only()) {
        const Impact impact = rational(kinds, points);
        return impact.start && separation.approaching_only ? Impact{} : impact;  // nothing is closer than contact
    }
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

bool surely_later(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const MinDistance& separation,
                  double time) {
    switch (kinds) {
        case FeatureKinds::vertex_face:
            return surely_later<FeatureKinds::vertex_face>(points, separation, time);
        case FeatureKinds::edge_edge:
            return surely_later<FeatureKinds::edge_edge>(points, separation, time);
        case FeatureKinds::vertex_edge:
            return surely_later<FeatureKinds::vertex_edge>(points, separation, time);
        case FeatureKinds::vertex_vertex:
            break;
    }
    return surely_later<FeatureKinds::vertex_vertex>(points, separation, time);
}

Impact decide_min_distance(FeatureKinds kinds, const std::array<MovingPoint, 4>& points, const MinDistance& separation,
                           MinDistanceCounts& counts) {
    const FilteredImpact found = quick(kinds, points, separation);
    if (found.verdict != Certainty::unknown) return {found.verdict == Certainty::meets, found.toi, found.start};
    ++counts.rational;
    return rational(kinds, points, separation);
}

}  // namespace crumple
