#include "exact/distance/exact_nearest.h"

#include <algorithm>
#include <span>
#include <utility>

#include "exact/intersection/exact_intersection.h"

namespace crumple {
namespace {

using Point = Vec3<Integer>;

/// Returns p + x (q - p) + y (r - p), rounded; all points are in units of 2^exponent.
Vec3d round_combination(const Point& p, const Quotient& x, const Point& q, const Quotient& y, const Point& r,
                        int exponent) {
    const Integer denominator = x.denominator * y.denominator;
    const Integer by_q = x.numerator * y.denominator, by_r = y.numerator * x.denominator;
    Vec3d rounded;
    for (int axis = 0; axis < 3; ++axis) {
        const Integer numerator = denominator * p[axis] + by_q * (q[axis] - p[axis]) + by_r * (r[axis] - p[axis]);
        rounded[axis] = round_quotient(numerator, denominator, exponent);
    }
    return rounded;
}

}  // namespace

int compare(const RationalDistance& x, const RationalDistance& y) {
    const int exponent = std::min(x.exponent(), y.exponent());
    const Integer left = x.quotient().numerator * y.quotient().denominator << 2 * (x.exponent() - exponent);
    const Integer right = y.quotient().numerator * x.quotient().denominator << 2 * (y.exponent() - exponent);
    return left.compare(right);
}

Witnesses closest_points(const Features& features, const RationalDistance& distance) {
    const std::span<const Vec3d> points(features.point.data(), points_of(features.kinds));
    const int exponent = common_exponent(points);
    std::array<Point, 4> p;
    for (std::size_t i = 0; i < points.size(); ++i) p[i] = in_units(points[i], exponent);
    const auto& [s, t] = distance.at();
    const Quotient none;
    const auto on_edge = [&](const Point& from, const Quotient& x, const Point& to) {
        return round_combination(from, x, to, none, from, exponent);
    };
    switch (features.kinds) {
        case FeatureKinds::vertex_face:
            return {on_edge(p[0], none, p[0]), round_combination(p[1], s, p[2], t, p[3], exponent)};
        case FeatureKinds::edge_edge:
            return {on_edge(p[0], s, p[1]), on_edge(p[2], t, p[3])};
        case FeatureKinds::vertex_edge:
            return {on_edge(p[0], none, p[0]), on_edge(p[1], s, p[2])};
        case FeatureKinds::vertex_vertex:
            break;
    }
    return {on_edge(p[0], none, p[0]), on_edge(p[1], none, p[1])};
}

RationalNearest::RationalNearest(const TrianglePoints& a, const TrianglePoints& b) {
    const RationalIntersection meeting = intersect_rationally({a, {0, 1, 2}}, {b, {3, 4, 5}});
    if (meeting.points.empty())
        find_least(a, b, (1U << triangle_features) - 1);
    else
        common_ = contact(meeting).points[0];
}

RationalNearest::RationalNearest(const TrianglePoints& a, const TrianglePoints& b, std::uint16_t features) {
    find_least(a, b, features);
}

void RationalNearest::find_least(const TrianglePoints& a, const TrianglePoints& b, std::uint16_t features) {
    for (std::size_t k = 0; k < triangle_features; ++k) {
        if (!(features >> k & 1U)) continue;
        const Features pair = features_of_triangles(a, b, k);
        RationalDistance distance(pair);
        if (distance_ && compare(distance, *distance_) >= 0) continue;
        distance_ = std::move(distance);
        features_ = pair;
        second_first_ = second_comes_first(k);
    }
}

int compare(const RationalNearest& x, const RationalNearest& y) {
    if (x.touching() || y.touching()) return static_cast<int>(y.touching()) - static_cast<int>(x.touching());
    return compare(*x.distance_, *y.distance_);
}

Witnesses RationalNearest::points() const {
    if (touching()) return {common_, common_};
    Witnesses points = closest_points(features_, *distance_);
    if (second_first_) std::swap(points[0], points[1]);
    return points;
}

}  // namespace crumple
