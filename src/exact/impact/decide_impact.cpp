#include "exact/impact/decide_impact.h"

#include "exact/impact/exact_impact.h"
#include "exact/impact/filtered_impact.h"

namespace crumple {
namespace {

template <FeaturePair pair>
Impact decide(const FourPoints& points, ImpactCounts& counts, Filtered filtered);

/// Returns an axis such that all four points stay in one plane perpendicular to it, or -1. The plane may move along the
/// axis.
int axis_of_common_plane(const FourPoints& points) {
    const auto common = [&](int axis) {
        for (const MovingPoint& p : points) {
            if (p.start[axis] != points[0].start[axis] || p.end[axis] != points[0].end[axis]) return false;
        }
        return true;
    };
    for (int axis = 0; axis < 3; ++axis) {
        if (common(axis)) return axis;
    }
    return -1;
}

/// Decides the impact of features that stay in a plane perpendicular to an axis and do not touch at the start. Their
/// first contact is then between a vertex of one and an edge of the other. A vertex meets an edge in the plane exactly
/// when the edge meets a segment through the vertex that is perpendicular to the plane.
template <FeaturePair pair>
Impact impact_in_plane(FourPoints points, int axis, ImpactCounts& counts) {
    for (MovingPoint& p : points) p.start[axis] = p.end[axis] = 0;
    Impact first;
    const auto vertex_meets_edge = [&](MovingPoint vertex, const MovingPoint& from, const MovingPoint& to) {
        MovingPoint above = vertex;
        vertex.start[axis] = vertex.end[axis] = -1;
        above.start[axis] = above.end[axis] = 1;
        const Impact impact = decide<FeaturePair::edge_edge>({from, to, vertex, above}, counts, Filtered::no);
        if (impact.meets && (!first.meets || impact.toi < first.toi)) first = impact;
    };
    const auto& [a, b, c, d] = points;
    if constexpr (pair == FeaturePair::vertex_face) {
        vertex_meets_edge(a, b, c);
        vertex_meets_edge(a, c, d);
        vertex_meets_edge(a, d, b);
    } else {
        vertex_meets_edge(a, c, d);
        vertex_meets_edge(b, c, d);
        vertex_meets_edge(c, a, b);
        vertex_meets_edge(d, a, b);
    }
    return first;
}

template <FeaturePair pair>
Impact decide(const FourPoints& points, ImpactCounts& counts, Filtered filtered) {
    const Approach<pair> x(points);
    if (x.in_range()) {
        const Volume volume(x);
        if (filtered == Filtered::no && surely_apart(x, volume)) return {};
        ++counts.roots;
        const FilteredImpact quick = first_impact(points, x, volume);
        if (quick.verdict != Certainty::unknown) return {quick.verdict == Certainty::meets, quick.toi, quick.start};
    } else {
        ++counts.roots;
    }
    const int contact = contact_at_start<pair>(points);
    if (contact > 0) return {true, 0, true};
    if (contact < 0) {
        if (const int axis = axis_of_common_plane(points); axis >= 0) {
            ImpactCounts of_edges;
            const Impact impact = impact_in_plane<pair>(points, axis, of_edges);
            counts.exact += of_edges.exact > 0;
            return impact;
        }
    }
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
