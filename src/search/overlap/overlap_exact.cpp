#include "search/overlap/overlap_exact.h"

namespace crumple {
namespace {

struct ExactPoint {
    Vec3<Integer> x;
    Integer w = 1;  ///< denominator of the coordinates; positive
};

/// Converts points to integer coordinates relative to the origin, in units of 2^exponent.
struct IntegerUnit {
    int exponent;
    Vec3<Integer> origin;

    template <std::size_t n>
    IntegerUnit(const Vec3d& origin, const std::array<Vec3d, n>& points)
        : exponent(common_exponent(points)), origin(in_units(origin, exponent)) {}

    ExactPoint at(const Vec3d& p) const { return {in_units(p, exponent) - origin}; }
    ExactPoint at(const CrossingEdge& edge) const {
        ExactPoint from = at(edge.from);
        if (edge.is_vertex()) return from;
        const auto corner = [&](std::size_t k) { return at(edge.face[k]).x; };
        const Vec3<Integer> to = at(edge.to).x, q = corner(0), normal = cross(corner(1) - q, corner(2) - q);
        Integer distance = dot(normal, from.x - q), all = distance - dot(normal, to - q);
        if (all < 0) distance = -distance, all = -all;
        return {all * from.x + distance * (to - from.x), all};
    }
    /// Adds numerators / denominator, in units of 2^(power * exponent).
    void add(const Vec3<Integer>& numerators, const Integer& denominator, int power,
             std::array<RationalSum, 3>& sums) const {
        for (int axis = 0; axis < 3; ++axis)
            sums[static_cast<std::size_t>(axis)].add(numerators[axis], denominator, power * exponent);
    }
    /// Adds `times` times the determinant of three points, and this number times the sum of the points, to the totals.
    void add_cone(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, int times,
                  VolumeTotals<RationalSum>& totals) const {
        const Integer cone = times * dot(p.x, cross(q.x, r.x)), w = p.w * q.w * r.w;
        totals.volume.add(cone, w, 3 * exponent);
        const Vec3<Integer> corners = Integer(q.w * r.w) * p.x + Integer(p.w * r.w) * q.x + Integer(p.w * q.w) * r.x;
        add(cone * corners, w * w, 4, totals.moment);
    }
};

IntegerUnit unit_of(const SurfacePair& surfaces, const FaceCorners& p) {
    return {surfaces.origin, std::array{surfaces.origin, p[0], p[1], p[2]}};
}
IntegerUnit unit_of(const SurfacePair& surfaces, const FaceCorners& p, const FaceCorners& q) {
    return {surfaces.origin, std::array{surfaces.origin, p[0], p[1], p[2], q[0], q[1], q[2]}};
}

}  // namespace

void ExactTerms::add_face(const FaceCorners& p, std::int32_t times, VolumeTotals<RationalSum>& totals) const {
    const IntegerUnit unit = unit_of(surfaces_, p);
    unit.add_cone(unit.at(p[0]), unit.at(p[1]), unit.at(p[2]), times, totals);
}

void ExactTerms::add(const Segment& segment, VolumeTotals<RationalSum>& totals) const {
    if (!segment.in_volume) return;
    const CrossingEdge from = crossing_edge(surfaces_, segment, segment.start),
                       to = crossing_edge(surfaces_, segment, segment.end);
    const bool has_length = !has_no_length(from, to);
    if (!has_length && segment.start.edge != 1 && segment.end.edge != 1) return;
    const std::array<FaceCorners, 2> face{surfaces_.corners_a(segment), surfaces_.corners_b(segment)};
    const IntegerUnit unit = unit_of(surfaces_, face[0], face[1]);
    const ExactPoint start = unit.at(from), end = unit.at(to);
    if (has_length) {
        unit.add_cone(unit.at(face[0][0]), start, end, 1, totals);
        unit.add_cone(unit.at(face[1][0]), end, start, 1, totals);
    }
    const auto add_edge = [&](const SegmentEnd& of, const ExactPoint& point) {
        const FaceCorners& p = face[of.side];
        if (of.edge == 1) unit.add_cone(unit.at(p[0]), point, unit.at(p[2]), of.jump, totals);
    };
    add_edge(segment.start, start);
    add_edge(segment.end, end);
}

void ExactTerms::add(const Segment& segment, CurveTotals<RationalSum>& totals) const {
    const CrossingEdge start = crossing_edge(surfaces_, segment, segment.start),
                       end = crossing_edge(surfaces_, segment, segment.end);
    if (segment.times == 0 || has_no_length(start, end)) return;
    const IntegerUnit unit = unit_of(surfaces_, surfaces_.corners_a(segment), surfaces_.corners_b(segment));
    const auto [s, v] = unit.at(start);
    const auto [e, w] = unit.at(end);
    const Integer both = v * w, times = segment.times;
    unit.add(times * cross(s, e), both, 2, totals.area);
    // Term of the torque for a segment from s/v to e/w: (e/w − s/v) ((s/v)² + (s/v) (e/w) + (e/w)²)
    const Integer square = dot(s, s) * w * w + dot(s, e) * both + dot(e, e) * v * v;
    unit.add(Integer(times * square) * (v * e - w * s), both * both * both, 3, totals.torque);
}

}  // namespace crumple
