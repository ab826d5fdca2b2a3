#include "search/overlap_exact.h"

namespace crumple {

ExactPoint ExactTerms::at(const CrossingEdge& edge) const {
    const ExactPoint from = at(edge.from);
    if (edge.is_vertex()) return from;
    const auto corner = [&](std::size_t k) { return at(edge.face[k]).x; };
    const Vec3<Integer> to = at(edge.to).x, q = corner(0), normal = cross(corner(1) - q, corner(2) - q);
    Integer distance = dot(normal, from.x - q), all = distance - dot(normal, to - q);
    if (all < 0) distance = -distance, all = -all;
    return {all * from.x + distance * (to - from.x), all};
}

void ExactTerms::add(const Vec3<Integer>& numerators, const Integer& denominator, int degree,
                     std::array<RationalSum, 3>& sums) const {
    for (int axis = 0; axis < 3; ++axis)
        sums[static_cast<std::size_t>(axis)].add(numerators[axis], denominator, degree * exponent_);
}

void ExactTerms::add_cone(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, int times,
                          VolumeTotals<RationalSum>& totals) const {
    const Integer cone = times * dot(p.x, cross(q.x, r.x)), w = p.w * q.w * r.w;
    totals.volume.add(cone, w, 3 * exponent_);
    const Vec3<Integer> corners = Integer(q.w * r.w) * p.x + Integer(p.w * r.w) * q.x + Integer(p.w * q.w) * r.x;
    add(cone * corners, w * w, 4, totals.moment);
}

void ExactTerms::add(const Segment& segment, VolumeTotals<RationalSum>& totals) const {
    if (!segment.in_volume) return;
    const ExactPoint start = at(CrossingEdge(scene_, segment, segment.start)),
                     end = at(CrossingEdge(scene_, segment, segment.end));
    const std::array<FaceCorners, 2> face{scene_.corners_a(segment), scene_.corners_b(segment)};
    add_cone(at(face[0][0]), start, end, 1, totals);
    add_cone(at(face[1][0]), end, start, 1, totals);
    const auto add_edge = [&](const SegmentEnd& of, const ExactPoint& point) {
        if (of.edge == 1) add_cone(at(face[of.side][0]), point, at(face[of.side][2]), of.jump, totals);
    };
    add_edge(segment.start, start);
    add_edge(segment.end, end);
}

void ExactTerms::add(const Segment& segment, CurveTotals<RationalSum>& totals) const {
    if (segment.times == 0) return;
    const auto [s, v] = at(CrossingEdge(scene_, segment, segment.start));
    const auto [e, w] = at(CrossingEdge(scene_, segment, segment.end));
    const Integer both = v * w, times = segment.times;
    add(times * cross(s, e), both, 2, totals.area);
    // (e/w − s/v) ((s/v)² + (s/v) (e/w) + (e/w)²)
    const Integer square = dot(s, s) * w * w + dot(s, e) * both + dot(e, e) * v * v;
    add(Integer(times * square) * (v * e - w * s), both * both * both, 3, totals.torque);
}

}  // namespace crumple
