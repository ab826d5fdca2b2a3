#include "search/overlap/overlap_extents.h"

#include <cmath>
#include <limits>
#include <optional>

#include "exact/overlap/rational_sum.h"
#include "exact/overlap/rounded_parameter.h"
#include "search/overlap/overlap_enclosed.h"

namespace crumple {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double nearest(const Rational& x, Cancellation& cancellation) {
    RationalSum sum;
    sum.add(x);
    return sum.rounded_quotient(1, cancellation).value;
}

Rational exact_dot(const Vec3d& normal, const Vec3d& p) {
    return Rational(normal.x) * Rational(p.x) + Rational(normal.y) * Rational(p.y) + Rational(normal.z) * Rational(p.z);
}

/// Returns the bounds of x as numbers without an error: a lower one, or an upper one if `upper`.
Enclosed bound(const Enclosed& x, bool upper) {
    if (x.error == 0) return x;
    const double error = (1 + 0x1p-40) * x.error + 0x1p-100 * x.magnitude();
    return {x.value + DoubleWord{upper ? error : -error, 0}, 0};
}
bool less(const Enclosed& x, const Enclosed& y) {
    return x.value.high < y.value.high || (x.value.high == y.value.high && x.value.low < y.value.low);
}

}  // namespace

template <class Act>
void ExtentSearch::for_each_vertex(Act act) const {
    for (std::size_t side = 0; side < 2; ++side)
        for (const VertexWinding& vertex : inside_[side]) act(surfaces_.surface[side]->points[vertex.vertex]);
}

template <class Act>
void ExtentSearch::for_each_end(Act act) const {
    for (const Segment& segment : segments_) {
        cancellation_.check();
        const SegmentEnd& end = segment.end;
        const FaceCorners of = surfaces_.corners(end.side, end.side == 0 ? segment.a : segment.b);
        act(of[end.edge], of[next_corner(end.edge)], [&] { return crossing_edge(surfaces_, segment, end); });
    }
}

OverlapExtent ExtentSearch::find(const Vec3d& normal) {
    if (inside_[0].empty() && inside_[1].empty() && segments_.empty()) return no_extent;
    OverlapExtent extent{no_bounds.low, no_bounds.high, no_extent.thickness};
    for_each_vertex([&](const Vec3d& p) {
        extent.low = min(extent.low, p);
        extent.high = max(extent.high, p);
    });
    const auto contains = [&](const Vec3d& p) {
        return p.x >= extent.low.x && p.y >= extent.low.y && p.z >= extent.low.z && p.x <= extent.high.x &&
               p.y <= extent.high.y && p.z <= extent.high.z;
    };
    for_each_end([&](const Vec3d& from, const Vec3d& to, auto edge) {
        if (!contains(from) || !contains(to)) widen_box(edge(), extent);
    });
    for (int axis = 0; axis < 3; ++axis) {  // never -0
        extent.low[axis] += 0.0;
        extent.high[axis] += 0.0;
    }
    if (all_finite(normal)) extent.thickness = thickness(normal, extent);
    return extent;
}

// Widens the box by the point at which an edge crosses a face, rounded outwards.
void ExtentSearch::widen_box(const CrossingEdge& edge, OverlapExtent& box) {
    std::optional<Enclosed> share;
    std::optional<RoundedParameter> rounded;
    for (int axis = 0; axis < 3; ++axis) {
        const auto widen = [&](double nearest, int rest) {  // `rest`: sign of the exact coordinate minus `nearest`
            box.low[axis] = std::fmin(box.low[axis], rest < 0 ? std::nextafter(nearest, -infinity) : nearest);
            box.high[axis] = std::fmax(box.high[axis], rest > 0 ? std::nextafter(nearest, infinity) : nearest);
        };
        const double from = edge.from[axis], to = edge.to[axis];
        // The point is in the boxes of the edge and of the face.
        const double p = edge.face[0][axis], q = edge.face[1][axis], r = edge.face[2][axis];
        if (max(min(from, to), min(p, min(q, r))) >= box.low[axis] &&
            min(max(from, to), max(p, max(q, r))) <= box.high[axis])
            continue;
        if (edge.is_vertex()) {
            widen(from, 0);
            continue;
        }
        if (surfaces_.in_range()) {
            if (!rounded) rounded = rounded_parameter(edge.from, edge.to, edge.face);
            if (RoundedNumber::between(from, to, *rounded).is_within(box.low[axis], box.high[axis])) continue;
            if (!share) share = enclosed_parameter(edge);
            const Enclosed x = Enclosed(from) + *share * Enclosed::difference(to, from);
            const auto [high, low] = x.value;
            if (std::abs(low) > 2 * x.error || x.error == 0) {
                widen(high, low > 0 ? 1 : low < 0 ? -1 : 0);
                continue;
            }
        }
        was_exact_ = true;
        const Rational x =
            Rational(from) + edge_parameter(edge.from, edge.to, edge.face) * (Rational(to) - Rational(from));
        const double middle = nearest(x, cancellation_);
        widen(middle, x.compare(Rational(middle)));
    }
}

void ExtentSearch::Greatest::add(const Enclosed& x) {
    const Enclosed low = bound(x, false), high = bound(x, true);
    if (empty || less(least, low)) least = low;
    if (empty || less(most, high)) most = high;
    empty = false;
}

// Returns the length of the interval of normal · x over all points x, correctly rounded. Heights in float64 show which
// vertices and edges may have the extremes; only theirs are computed in double-double arithmetic.
double ExtentSearch::thickness(const Vec3d& normal, const OverlapExtent& box) {
    // Smaller components might make products underflow.
    const auto is_small = [](double x) { return x != 0 && std::abs(x) < 0x1p-200; };
    if (!surfaces_.in_range() || is_small(normal.x) || is_small(normal.y) || is_small(normal.z))
        return exact_thickness(normal, {}, {});
    const Vec3d& origin = surfaces_.origin;
    const auto rounded_height = [&](const Vec3d& p) { return dot(normal, p - origin); };
    const Vec3<Enclosed> n{Enclosed(normal.x), Enclosed(normal.y), Enclosed(normal.z)};
    const auto height = [&](const Vec3d& p) { return dot(n, enclosed_difference(p, origin)); };

    const Vec3d size = max(abs(box.low - origin), abs(box.high - origin));
    const double error = 0x1p-48 * (size.x + size.y + size.z);  // bound for heights of points in the box
    double low = infinity, high = -infinity;
    for_each_vertex([&](const Vec3d& p) {
        const double h = rounded_height(p);
        low = std::fmin(low, h), high = std::fmax(high, h);
    });
    low += error, high -= error;
    Greatest highest, minus_lowest;
    const auto add = [&](const Enclosed& x) {
        highest.add(x);
        minus_lowest.add(-x);
    };
    for_each_vertex([&](const Vec3d& p) {
        if (const double h = rounded_height(p); h <= low + error || h >= high - error) add(height(p));
    });
    for_each_end([&](const Vec3d& from, const Vec3d& to, auto edge) {
        const double a = rounded_height(from), b = rounded_height(to);
        Vec3d beyond = max(abs(from - origin), abs(to - origin));
        double slack = error + 0x1p-48 * (beyond.x + beyond.y + beyond.z);
        if (std::fmin(a, b) > low + slack && std::fmax(a, b) < high - slack) return;
        const CrossingEdge crossing = edge();
        if (!crossing.is_vertex()) {  // the point is also in the face
            double lowest = infinity, highest_of_face = -infinity;
            for (const Vec3d& q : crossing.face) {
                lowest = min(lowest, rounded_height(q)), highest_of_face = max(highest_of_face, rounded_height(q));
                beyond = max(beyond, abs(q - origin));
            }
            slack = error + 0x1p-48 * (beyond.x + beyond.y + beyond.z);
            if (max(min(a, b), lowest) > low + slack && min(max(a, b), highest_of_face) < high - slack) return;
            const RoundedParameter t = rounded_parameter(crossing.from, crossing.to, crossing.face);
            if (RoundedNumber::between(a, b, t, slack).is_within(low + slack, high - slack)) return;
        }
        const Enclosed start = height(crossing.from);
        const Enclosed x =
            crossing.is_vertex() ? start : start + enclosed_parameter(crossing) * (height(crossing.to) - start);
        add(x);
        const double h = x.value.high;
        low = std::fmin(low, h + error), high = std::fmax(high, h - error);
    });
    const auto least = nearest_quotient(highest.least + minus_lowest.least, 1),
               most = nearest_quotient(highest.most + minus_lowest.most, 1);
    if (least && most && *least == *most) return *least;
    return exact_thickness(normal, highest, minus_lowest);
}

// Computes the thickness exactly. `highest`, `minus_lowest`: bounds on the extremes, or empty.
double ExtentSearch::exact_thickness(const Vec3d& normal, const Greatest& highest, const Greatest& minus_lowest) {
    was_exact_ = true;
    const auto number = [](const Enclosed& x) -> Rational { return Rational(x.value.high) + Rational(x.value.low); };
    std::optional<Rational> low, high;
    if (!highest.empty) {
        const Rational at_origin = exact_dot(normal, surfaces_.origin);
        high = number(highest.least) + at_origin;
        low = at_origin - number(minus_lowest.least);
    }
    const auto add = [&](const Rational& x) {
        if (!low || x < *low) low = x;
        if (!high || x > *high) high = x;
    };
    for_each_vertex([&](const Vec3d& p) {
        cancellation_.check();
        add(exact_dot(normal, p));
    });
    for_each_end([&](const Vec3d& edge_from, const Vec3d& edge_to, auto edge) {
        const Rational from = exact_dot(normal, edge_from), to = exact_dot(normal, edge_to);
        if (low && std::min(from, to) >= *low && std::max(from, to) <= *high) return;
        const CrossingEdge at = edge();
        add(at.is_vertex() ? exact_dot(normal, at.from)
                           : Rational(from + edge_parameter(at.from, at.to, at.face) * (to - from)));
    });
    return nearest(*high - *low, cancellation_);
}

}  // namespace crumple
