#include "exact/impact/decide_impact.h"

#include "exact/impact/quick_impact.h"
#include "exact/impact/rational_impact.h"

namespace crumple {
namespace {

template <FeaturePair pair>
Impact decide(const FourPoints& points, ImpactCounts& counts, Filtered filtered) {
    const Approach<pair> x(points);
    if (x.in_range()) {
        const Volume volume(x);
        if (filtered == Filtered::no && surely_apart(x, volume)) return {};
        ++counts.roots;
        const QuickImpact quick = first_impact(points, x, volume);
        if (quick.verdict != Certainty::unknown) return {quick.verdict == Certainty::meets, quick.toi, quick.start};
    } else {
        ++counts.roots;
    }
    if (surely_touch_at_start<pair>(points)) return {true, 0, true};
    ++counts.exact;
    const auto& [p, q, r, s] = points;
    return pair == FeaturePair::vertex_face ? vertex_face(p, q, r, s) : edge_edge(p, q, r, s);
}

}  // namespace

Impact vertex_face_impact(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                          ImpactCounts& counts, Filtered filtered) {
    return decide<FeaturePair::vertex_face>({p, a, b, c}, counts, filtered);
}

Impact edge_edge_impact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                        ImpactCounts& counts, Filtered filtered) {
    return decide<FeaturePair::edge_edge>({a, b, c, d}, counts, filtered);
}

}  // namespace crumple
