#include "exact/intersection/exact_intersection.h"

#include <algorithm>
#include <cmath>

namespace crumple {
namespace {

using Point = Vec3<Integer>;
using Corners = std::array<Point, 3>;

/// Plane normal · x = offset, or half-space normal · x ≥ offset.
struct Plane {
    Point normal;
    Integer offset;

    Plane(const Point& direction, const Point& through) : normal(direction), offset(dot(direction, through)) {}
    Integer operator()(const Point& p) const { return dot(normal, p) - offset; }
    Integer operator()(const RationalPoint& p) const { return dot(normal, p.xyz) - offset * p.w; }
};

/// Returns the plane through a triangle; its normal is zero if the triangle is degenerate.
Plane plane_through(const Corners& corner) { return {cross(corner[1] - corner[0], corner[2] - corner[0]), corner[0]}; }

bool before(const Point& p, const Point& q) { return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z; }

/// Convex hull of three points: { x : every plane of `on` is 0, every plane of `within` is ≥ 0 }.
struct Hull {
    Point normal;  ///< zero if degenerate
    bool degenerate;
    std::vector<Plane> on, within;
    std::vector<std::array<Point, 2>> edges;

    Hull(const Corners& corner, const Plane& plane) : normal(plane.normal), degenerate(normal == Point{}) {
        on.reserve(3);
        within.reserve(6);
        edges.reserve(3);
        if (degenerate) {
            const auto [first, last] = std::minmax_element(corner.begin(), corner.end(), before);
            add_segment(*first, *last);
            return;
        }
        on.push_back(plane);
        for (std::size_t i = 0; i < 3; ++i) {
            const Point& p = corner[i];
            const Point& q = corner[(i + 1) % 3];
            within.emplace_back(cross(normal, q - p), p);
            edges.push_back({p, q});
        }
    }

    /// Adds the line through both ends, and the box that they span. For equal ends only the box remains, which is then
    /// the point.
    void add_segment(const Point& p, const Point& q) {
        for (int axis = 0; axis < 3; ++axis) {
            Point unit;
            unit[axis] = 1;
            on.emplace_back(cross(unit, q - p), p);
            within.emplace_back(unit, p[axis] < q[axis] ? p : q);
            within.emplace_back(Point{} - unit, p[axis] < q[axis] ? q : p);
        }
        edges.push_back({p, q});
    }

    bool contains(const RationalPoint& p) const {
        return std::all_of(on.begin(), on.end(), [&](const Plane& plane) { return plane(p) == 0; }) &&
               std::all_of(within.begin(), within.end(), [&](const Plane& plane) { return plane(p) >= 0; });
    }
};

/// numerator / denominator, the latter positive.
struct Fraction {
    Integer numerator, denominator;
    friend bool operator<(const Fraction& s, const Fraction& t) {
        return s.numerator * t.denominator < t.numerator * s.denominator;
    }
};

/// Returns the parameter at which a linear function vanishes on a segment, if it is f_p at the start and f_q ≠ f_p at
/// the end.
Fraction zero_between(const Integer& f_p, const Integer& f_q) {
    return f_q > f_p ? Fraction{-f_p, f_q - f_p} : Fraction{f_p, f_p - f_q};
}

RationalPoint point_at(const std::array<Point, 2>& edge, const Fraction& t) {
    return {(t.denominator - t.numerator) * edge[0] + t.numerator * edge[1], t.denominator};
}

/// Values of a linear function at both ends of an edge.
struct Ends {
    Integer p, q;
};

Ends ends(const Plane& plane, const std::array<Point, 2>& edge) { return {plane(edge[0]), plane(edge[1])}; }

/// Appends the ends of the part of an edge that lies in the hull. Returns true if the ends of the edge are strictly on
/// opposite sides of the hull's plane and the edge meets the hull's inside.
bool clip(const std::array<Point, 2>& edge, const Hull& hull, std::vector<RationalPoint>& points) {
    Fraction begin{0, 1}, end{1, 1};
    // Cuts away what is below zero; false if nothing is left.
    const auto cut = [&](const Ends& f) {
        if (f.p < 0 && f.q < 0) return false;
        if (f.p < 0) begin = std::max(begin, zero_between(f.p, f.q));
        if (f.q < 0) end = std::min(end, zero_between(f.p, f.q));
        return true;
    };
    bool crosses = !hull.degenerate;
    for (const Plane& plane : hull.on) {
        const Ends f = ends(plane, edge);
        if (!cut(f) || !cut({-f.p, -f.q})) return false;
        crosses = crosses && f.p.sign() * f.q.sign() < 0;
    }
    // An edge that crosses the plane has been cut to one point: `begin`.
    for (const Plane& plane : hull.within) {
        const Ends f = ends(plane, edge);
        if (!cut(f)) return false;
        crosses = crosses && (begin.denominator - begin.numerator) * f.p + begin.numerator * f.q > 0;
    }
    if (end < begin) return false;
    points.push_back(point_at(edge, begin));
    if (begin < end) points.push_back(point_at(edge, end));
    return crosses;
}

/// Returns −1, 0 or 1 if p comes before, equals, or comes after q in lexicographic order.
int compare(const RationalPoint& p, const RationalPoint& q) {
    for (int axis = 0; axis < 3; ++axis) {
        const int order = Integer(p.xyz[axis] * q.w).compare(q.xyz[axis] * p.w);
        if (order != 0) return order < 0 ? -1 : 1;
    }
    return 0;
}

/// Returns q − p, times a positive number.
Point difference(const RationalPoint& q, const RationalPoint& p) { return p.w * q.xyz - q.w * p.xyz; }

/// Returns the extreme points, counter-clockwise about the normal from the lexicographically smallest. Points that are
/// not collinear must lie in a plane with that normal. (Andrew's monotone chain: lexicographic order is the order along
/// a direction that no two points share, which is all that the chain needs.)
std::vector<RationalPoint> extreme_points(std::vector<RationalPoint> points, const Point& normal) {
    std::sort(points.begin(), points.end(), [](const auto& p, const auto& q) { return compare(p, q) < 0; });
    const auto same = [](const auto& p, const auto& q) { return compare(p, q) == 0; };
    points.erase(std::unique(points.begin(), points.end(), same), points.end());
    if (points.size() < 2) return points;
    std::vector<RationalPoint> chain;
    const auto extend = [&](const RationalPoint& next, std::size_t keep) {
        while (chain.size() > keep) {
            const RationalPoint& last = chain[chain.size() - 1];
            if (dot(normal, cross(difference(last, chain[chain.size() - 2]), difference(next, last))) > 0) break;
            chain.pop_back();
        }
        chain.push_back(next);
    };
    for (const RationalPoint& p : points) extend(p, 1);
    const std::size_t lower = chain.size();
    for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], lower);
    chain.pop_back();
    return chain;
}

/// True if all corners lie strictly on one side of a triangle's plane, so that the triangles are disjoint; false if
/// there is no plane.
bool on_one_side(const Corners& corners, const Plane& plane) {
    const int side = plane(corners[0]).sign();
    return side != 0 && plane(corners[1]).sign() == side && plane(corners[2]).sign() == side;
}

/// Returns the positions of the distinct vertices that both triangles have.
std::vector<Point> shared_vertices(const Triangle& a, const Triangle& b, const Corners& corners_of_a) {
    std::vector<Point> shared;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto* const vertex = &a.vertex[i];
        const bool first = std::find(a.vertex.data(), vertex, *vertex) == vertex;
        const bool in_b = std::find(b.vertex.begin(), b.vertex.end(), *vertex) != b.vertex.end();
        if (first && in_b) shared.push_back(corners_of_a[i]);
    }
    return shared;
}

}  // namespace

double round_quotient(const Integer& numerator, const Integer& denominator, int exponent) {
    if (numerator == 0) return 0;
    constexpr int precision = 53, least_unit = -1074;
    const auto shifted = [](const Integer& x, int shift) { return shift > 0 ? Integer(x << shift) : x; };
    const Integer magnitude = mp::abs(numerator);
    int power = static_cast<int>(msb(magnitude)) - static_cast<int>(msb(denominator));
    if (shifted(magnitude, -power) < shifted(denominator, power)) --power;
    // Now 2^power ≤ quotient < 2^(power + 1); `unit` is the exponent of the last place of the result.
    const int unit = std::max(power + exponent - precision + 1, least_unit);
    const Integer divisor = shifted(denominator, unit - exponent);
    Integer places, remainder;
    divide_qr(shifted(magnitude, exponent - unit), divisor, places, remainder);
    const int half = Integer(2 * remainder).compare(divisor);
    if (half > 0 || (half == 0 && bit_test(places, 0))) ++places;
    const double rounded = std::ldexp(static_cast<double>(static_cast<std::int64_t>(places)), unit);
    return numerator < 0 && rounded != 0 ? -rounded : rounded;
}

RationalIntersection intersect_rationally(const Triangle& a, const Triangle& b) {
    RationalIntersection result;
    const auto& [a0, a1, a2] = a.point;
    const auto& [b0, b1, b2] = b.point;
    result.exponent = common_exponent(std::array{a0, a1, a2, b0, b1, b2});
    const Corners corners_a = in_units(a.point, result.exponent), corners_b = in_units(b.point, result.exponent);
    const Plane plane_a = plane_through(corners_a), plane_b = plane_through(corners_b);
    if (on_one_side(corners_b, plane_a) || on_one_side(corners_a, plane_b)) return result;
    const Hull hull_a(corners_a, plane_a), hull_b(corners_b, plane_b);

    for (const auto& edge : hull_a.edges) result.proper |= clip(edge, hull_b, result.points);
    for (const auto& edge : hull_b.edges) result.proper |= clip(edge, hull_a, result.points);
    result.points = extreme_points(std::move(result.points), hull_a.normal);

    const std::vector<Point> shared = shared_vertices(a, b, corners_a);
    result.shared = static_cast<int>(shared.size());
    if (shared.empty() || shared.size() == 3) {
        result.collides = !result.points.empty();  // three shared vertices: the same points, which meet
    } else {
        const Corners segment{shared.front(), shared.back(), shared.back()};
        const Hull common(segment, plane_through(segment));
        result.collides = !std::all_of(result.points.begin(), result.points.end(),
                                       [&](const RationalPoint& p) { return common.contains(p); });
    }
    return result;
}

bool collide(const RationalIntersection& intersection, Neighbours neighbours, IntersectionKind intersections) {
    if (neighbours == Neighbours::skip && intersection.shared > 0) return false;
    return intersections == IntersectionKind::proper ? intersection.proper : intersection.collides;
}

Contact contact(const RationalIntersection& intersection) {
    Contact result;
    for (const RationalPoint& p : intersection.points) {
        Vec3d& rounded = result.points[static_cast<std::size_t>(result.count++)];
        for (int axis = 0; axis < 3; ++axis) rounded[axis] = round_quotient(p.xyz[axis], p.w, intersection.exponent);
    }
    return result;
}

Vec3d round_crossing(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& triangle) {
    const int exponent = common_exponent(std::array{p, q, triangle[0], triangle[1], triangle[2]});
    const Corners corner = in_units(triangle, exponent);
    const std::array<Point, 2> line{in_units(p, exponent), in_units(q, exponent)};
    const Plane plane = plane_through(corner);
    const RationalPoint crossing = point_at(line, zero_between(plane(line[0]), plane(line[1])));
    Vec3d rounded;
    for (int axis = 0; axis < 3; ++axis) rounded[axis] = round_quotient(crossing.xyz[axis], crossing.w, exponent);
    return rounded;
}

}  // namespace crumple
