#include "exact/proximity/rational_distance.h"

#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "exact/intersection/exact_intersection.h"

namespace crumple {
namespace {

using Point = Vec3<Integer>;

bool operator<(const Quotient& x, const Quotient& y) {
    return x.numerator * y.denominator < y.numerator * x.denominator;
}
bool operator==(const Quotient& x, const Quotient& y) {
    return x.numerator * y.denominator == y.numerator * x.denominator;
}

Quotient complement(const Quotient& x) { return {x.denominator - x.numerator, x.denominator}; }

/// Pair of parts of the features, with its squared distance and the parameters of its closest points.
struct Parts {
    Quotient squared;
    std::uint8_t type = 0;
    std::array<Quotient, 2> at;
};

template <class Type>
std::uint8_t number(Type type) {
    return static_cast<std::uint8_t>(type);
}

/// Replaces `best` by `other` if that is closer, or equally close and of lower type.
void keep_closer(Parts& best, Parts&& other) {
    if (other.squared < best.squared || (other.type < best.type && other.squared == best.squared)) {
        best = std::move(other);
    }
}

Quotient squared_length(const Point& v) { return {dot(v, v), 1}; }

Parts vertex_edge(const Point& p, const Point& a, const Point& b) {
    const Point along = b - a;
    const Integer place = dot(p - a, along), length = dot(along, along);
    if (place <= 0) return {squared_length(p - a), number(VertexEdgeType::P_E0), {Quotient{0}, Quotient{0}}};
    if (place >= length) return {squared_length(p - b), number(VertexEdgeType::P_E1), {Quotient{1}, Quotient{0}}};
    const Point moment = cross(p - a, along);
    return {{dot(moment, moment), length}, number(VertexEdgeType::P_E), {Quotient{place, length}, Quotient{0}}};
}

/// Conversion of types: for each VertexEdgeType of a vertex and an edge, the type (VertexFaceType or EdgeEdgeType) of a
/// larger pair of features, of which these two are parts.
template <class Type>
using Names = std::array<Type, 3>;

Parts vertex_face(const Point& p, const Point& a, const Point& b, const Point& c) {
    const Point normal = cross(b - a, c - a);
    // Positive if p projects to the inner side of the edge; 0 for all edges if the face is degenerate.
    const auto inner = [&](const Point& from, const Point& to) { return dot(normal, cross(to - from, p - from)); };
    const Integer u = inner(c, a), v = inner(a, b);
    if (u > 0 && v > 0 && inner(b, c) > 0) {
        const Integer height = dot(normal, p - a), area = dot(normal, normal);
        return {{height * height, area}, number(VertexFaceType::P_T), {Quotient{u, area}, Quotient{v, area}}};
    }
    using enum VertexFaceType;
    const auto edge = [&](const Point& from, const Point& to, const Names<VertexFaceType>& names) {
        Parts parts = vertex_edge(p, from, to);
        parts.type = number(names[parts.type]);
        return parts;
    };
    Parts best = edge(a, b, {P_T0, P_T1, P_E0});
    Parts second = edge(b, c, {P_T1, P_T2, P_E1});
    second.at = {complement(second.at[0]), second.at[0]};
    keep_closer(best, std::move(second));
    Parts third = edge(c, a, {P_T2, P_T0, P_E2});
    third.at = {Quotient{0}, complement(third.at[0])};
    keep_closer(best, std::move(third));
    return best;
}

Parts edge_edge(const Point& a, const Point& b, const Point& c, const Point& d) {
    const Point along = b - a, other = d - c, between = c - a, normal = cross(along, other);
    const Integer s = dot(cross(between, other), normal), t = dot(cross(between, along), normal);
    const Integer area = dot(normal, normal);
    if (0 < s && s < area && 0 < t && t < area) {
        const Integer height = dot(normal, between);
        return {{height * height, area}, number(EdgeEdgeType::EA_EB), {Quotient{s, area}, Quotient{t, area}}};
    }
    using enum EdgeEdgeType;
    const auto on_second = [&](const Point& p, const Quotient& at, const Names<EdgeEdgeType>& names) {
        Parts parts = vertex_edge(p, c, d);
        parts.type = number(names[parts.type]);
        parts.at = {at, parts.at[0]};
        return parts;
    };
    const auto on_first = [&](const Point& p, const Quotient& at, const Names<EdgeEdgeType>& names) {
        Parts parts = vertex_edge(p, a, b);
        parts.type = number(names[parts.type]);
        parts.at = {parts.at[0], at};
        return parts;
    };
    Parts best = on_second(a, Quotient{0}, {EA0_EB0, EA0_EB1, EA0_EB});
    keep_closer(best, on_second(b, Quotient{1}, {EA1_EB0, EA1_EB1, EA1_EB}));
    keep_closer(best, on_first(c, Quotient{0}, {EA0_EB0, EA1_EB0, EA_EB0}));
    keep_closer(best, on_first(d, Quotient{1}, {EA0_EB1, EA1_EB1, EA_EB1}));
    return best;
}

Parts closest_parts(FeatureKinds kinds, const std::array<Point, 4>& point) {
    const auto& [p, q, r, s] = point;
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
    return {squared_length(p - q), 0, {Quotient{0}, Quotient{0}}};
}

/// Returns floor(log2(x)) for x > 0.
int power_of(const Quotient& x) {
    const int power = static_cast<int>(msb(x.numerator)) - static_cast<int>(msb(x.denominator));
    const bool below =
        power < 0 ? Integer(x.numerator << -power) < x.denominator : x.numerator < Integer(x.denominator << power);
    return below ? power - 1 : power;
}

}  // namespace

RationalDistance::RationalDistance(const Features& features) {
    const std::span<const Vec3d> points(features.point.data(), points_of(features.kinds));
    exponent_ = common_exponent(points);
    std::array<Point, 4> integer_points;
    for (std::size_t i = 0; i < points.size(); ++i) integer_points[i] = in_units(points[i], exponent_);
    Parts parts = closest_parts(features.kinds, integer_points);
    squared_ = std::move(parts.squared);
    at_ = std::move(parts.at);
    type_ = parts.type;
}

bool RationalDistance::within(const DistanceLimit& reach) const {
    const int exponent = std::min(exponent_, common_exponent(std::array{Vec3d{reach.a, reach.b, 0}}));
    const Integer sum = in_units(reach.a, exponent) + in_units(reach.b, exponent);
    const int order =
        Integer(squared_.numerator << 2 * (exponent_ - exponent)).compare(sum * sum * squared_.denominator);
    return reach.strict ? order < 0 : order <= 0;
}

double RationalDistance::squared() const {
    return round_quotient(squared_.numerator, squared_.denominator, 2 * exponent_);
}

double RationalDistance::rounded_down() const {
    if (touching()) return 0;
    constexpr int precision = 53, least_unit = -1074;
    // 2^power ≤ distance < 2^(power + 1); `unit` is the exponent of the last place of the result.
    const int power = (power_of(squared_) + 2 * exponent_) >> 1;
    if (power >= 1024) return std::numeric_limits<double>::max();
    const int unit = std::max(power - precision + 1, least_unit), shift = 2 * (exponent_ - unit);
    const Integer places = shift < 0 ? Integer(squared_.numerator / Integer(squared_.denominator << -shift))
                                     : Integer(Integer(squared_.numerator << shift) / squared_.denominator);
    return std::ldexp(static_cast<double>(static_cast<std::int64_t>(Integer(sqrt(places)))), unit);
}

double RationalDistance::rounded() const {
    const double low = rounded_down();
    // The distance exceeds 0, so it is between `low` and the next number; `unit` is the exponent of their difference.
    if (touching()) return 0;
    constexpr int precision = 53, least_unit = -1074;
    const int unit = low == 0 ? least_unit : std::max(std::ilogb(low) - precision + 1, least_unit);
    const auto units = static_cast<std::int64_t>(std::ldexp(low, -unit));
    const Integer middle = 2 * Integer(units) + 1;  // in units of 2^(unit - 1)
    const int shift = 2 * (exponent_ - (unit - 1));
    const Integer numerator = shift < 0 ? squared_.numerator : Integer(squared_.numerator << shift);
    const Integer denominator = shift < 0 ? Integer(squared_.denominator << -shift) : squared_.denominator;
    const int order = numerator.compare(middle * middle * denominator);
    if (order < 0 || (order == 0 && units % 2 == 0)) return low;
    return std::nextafter(low, std::numeric_limits<double>::infinity());
}

ClosestPoints RationalDistance::closest() const {
    const auto rounded = [](const Quotient& x) { return round_quotient(x.numerator, x.denominator, 0); };
    return {type_, {rounded(at_[0]), rounded(at_[1])}};
}

}  // namespace crumple
