#include "exact/impact/exact_impact.h"

#include <array>
#include <initializer_list>

#include "exact/impact/paths.h"
#include "exact/impact/roots.h"

namespace crumple {
namespace {

/// Returns twice the signed area of a b c, projected along an axis.
Polynomial turn(const Path& a, const Path& b, const Path& c, int along) {
    const int i = (along + 1) % 3, j = (along + 2) % 3;
    return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
}

// The functions below test if features touch at one time t. The caller has found t as a root of the polynomials that
// must be 0 for a contact, so these are not tested again.

bool vanishes(const Path& path, Root& t) { return t.sign(path.x) == 0 && t.sign(path.y) == 0 && t.sign(path.z) == 0; }

/// Returns the first axis along which a vector has a component, or −1 for the zero vector.
int axis_of(const Path& vector, Root& t) {
    for (int axis = 0; axis < 3; ++axis) {
        if (t.sign(vector[axis]) != 0) return axis;
    }
    return -1;
}

/// True if p lies in segment a b. Precondition: p lies on a line through a and b, which may coincide.
bool between(const Path& p, const Path& a, const Path& b, Root& t) { return t.sign(dot(p - a, p - b)) <= 0; }

bool on_edge(const Path& p, const Path& a, const Path& b, Root& t) {
    return between(p, a, b, t) && vanishes(cross(p - a, b - a), t);
}

/// True if p lies in face a b c. Precondition: the four points are coplanar.
bool in_face(const Path& p, const Path& a, const Path& b, const Path& c, Root& t) {
    const Path normal = cross(b - a, c - a);
    const int axis = axis_of(normal, t);
    // Without a normal the face is the union of its edges.
    if (axis < 0) return on_edge(p, a, b, t) || on_edge(p, b, c, t) || on_edge(p, c, a, t);
    const int side = t.sign(normal[axis]);
    const auto inside = [&](const Path& from, const Path& to) { return t.sign(turn(from, to, p, axis)) * side >= 0; };
    return inside(a, b) && inside(b, c) && inside(c, a);
}

/// True if edges a b and c d touch. Precondition: the four points are coplanar.
bool edges_touch(const Path& a, const Path& b, const Path& c, const Path& d, Root& t) {
    const int axis = axis_of(cross(b - a, d - c), t);
    // If edges that are parallel or degenerate touch, one of them contains an end of the other.
    if (axis < 0) return on_edge(a, c, d, t) || on_edge(b, c, d, t) || on_edge(c, a, b, t) || on_edge(d, a, b, t);
    const auto apart = [&](const Path& from, const Path& to, const Path& p, const Path& q) {
        return t.sign(turn(from, to, p, axis)) * t.sign(turn(from, to, q, axis)) > 0;
    };
    return !apart(a, b, c, d) && !apart(c, d, a, b);
}

// The functions below compute the time at which features first touch.

Impact impact_at(Root& t) { return {true, t.rounded_down(), t.is_zero()}; }

/// Returns the impact at the first root of p at which the features touch; p is not 0.
template <class Touch>
Impact first_root(const Polynomial& p, Touch touch) {
    for (Root& t : roots_in_unit_interval(p)) {
        if (touch(t)) return impact_at(t);
    }
    return {};
}

/// Returns the impact at the start if the features touch then, otherwise the first of the impacts of their vertices and
/// edges. Rounding is monotone, so the least of the rounded times is the least time, rounded.
template <class Touch>
Impact start_or_first_of(Touch touch, std::initializer_list<Impact> smaller) {
    Root start(Dyadic{0, 0});
    if (touch(start)) return impact_at(start);
    Impact first;
    for (const Impact& impact : smaller) {
        if (impact.meets && (!first.meets || impact.toi < first.toi)) first = impact;
    }
    return first;
}

Impact impact(const Path& p, const Path& q) {
    const Path difference = p - q;
    const Polynomial all = greatest_common_divisor(std::array{difference.x, difference.y, difference.z});
    if (all.zero()) return {true, 0, true};
    return first_root(all, [](Root&) { return true; });
}

Impact impact(const Path& p, const Path& a, const Path& b) {
    const Path normal = cross(p - a, b - a);
    const Polynomial all = greatest_common_divisor(std::array{normal.x, normal.y, normal.z});
    const auto touch = [&](Root& t) { return between(p, a, b, t); };
    if (!all.zero()) return first_root(all, touch);
    return start_or_first_of(touch, {impact(p, a), impact(p, b)});
}

}  // namespace

Impact vertex_face(const MovingPoint& vertex, const MovingPoint& first, const MovingPoint& second,
                   const MovingPoint& third) {
    const auto [p, a, b, c] = paths(std::array{vertex, first, second, third});
    const Polynomial volume = dot(cross(b - a, c - a), p - a);
    const auto touch = [&, &p = p, &a = a, &b = b, &c = c](Root& t) { return in_face(p, a, b, c, t); };
    if (!volume.zero()) return first_root(volume, touch);
    return start_or_first_of(touch, {impact(p, a, b), impact(p, b, c), impact(p, c, a)});
}

Impact edge_edge(const MovingPoint& first, const MovingPoint& second, const MovingPoint& third,
                 const MovingPoint& fourth) {
    const auto [a, b, c, d] = paths(std::array{first, second, third, fourth});
    const Polynomial volume = dot(cross(b - a, d - c), c - a);
    const auto touch = [&, &a = a, &b = b, &c = c, &d = d](Root& t) { return edges_touch(a, b, c, d, t); };
    if (!volume.zero()) return first_root(volume, touch);
    return start_or_first_of(touch, {impact(a, c, d), impact(b, c, d), impact(c, a, b), impact(d, a, b)});
}

Impact vertex_edge(const MovingPoint& vertex, const MovingPoint& first, const MovingPoint& second) {
    const auto [p, a, b] = paths(std::array{vertex, first, second});
    return impact(p, a, b);
}

Impact vertex_vertex(const MovingPoint& first, const MovingPoint& second) {
    const auto [p, q] = paths(std::array{first, second});
    return impact(p, q);
}

}  // namespace crumple
