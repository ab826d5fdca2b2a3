#include "io/meshes/triangulate.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "geometry/predicates.h"

namespace crumple::io {
namespace {

constexpr std::int8_t cut_off = 2;

/// Returns the exact sign of the turn a, b, c (the orientation of the triangle, projected along axis `dropped`), for
/// coordinates beyond the range of floating-point expansions. Computes with integers, in units of a power of two that
/// divides all coordinates. Rationals would take a hundred times as long, because they are reduced after each
/// operation.
int integer_turn(const Vec3d& a, const Vec3d& b, const Vec3d& c, int dropped) {
    using Integer = boost::multiprecision::cpp_int;
    const int x = first_axis(dropped), y = second_axis(dropped);
    const auto last_bit = [](double value) { return std::ilogb(value) - 52; };
    int unit = 1024;
    for (const double value : {a[x], a[y], b[x], b[y], c[x], c[y]})
        if (value != 0) unit = std::min(unit, last_bit(value));
    const auto whole = [&](double value) {
        if (value == 0) return Integer(0);
        const Integer digits = static_cast<std::int64_t>(std::scalbn(value, -last_bit(value)));
        return Integer(digits << (last_bit(value) - unit));
    };
    const auto difference = [&](const Vec3d& p, int axis) { return Integer(whole(p[axis]) - whole(a[axis])); };
    return Integer(difference(b, x) * difference(c, y) - difference(b, y) * difference(c, x)).sign();
}

/// Adds up the cross products of successive corners, relative to the first, in `normal`, and their absolute values, by
/// component, in `magnitude`. Scales coordinates so that nothing overflows or underflows; both sums have an arbitrary
/// unit.
void add_up_cross_products(std::span<const Vec3d> points, Vec3d& normal, Vec3d& magnitude) {
    double largest = 0;
    const auto half_difference = [&](std::size_t i) { return 0.5 * points[i] - 0.5 * points[0]; };
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Vec3d d = abs(half_difference(i));
        largest = std::max({largest, d.x, d.y, d.z});
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    const auto scaled = [&](std::size_t i) {
        const Vec3d d = half_difference(i);
        return Vec3d{std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent)};
    };
    Vec3d previous = scaled(1);
    for (std::size_t i = 2; i < points.size(); ++i) {
        const Vec3d next = scaled(i), product = cross(previous, next);
        normal = normal + product;
        magnitude = magnitude + abs(product);
        previous = next;
    }
}

int largest_component(const Vec3d& v) {
    const Vec3d a = abs(v);
    return a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
}

}  // namespace

bool Triangulator::cut(std::span<const Vec3d> points, std::vector<std::int32_t>& ears) {
    points_ = points;
    count_ = static_cast<int>(points.size());
    if (!find_plane() || has_good_fan()) return true;
    if (crosses_itself()) return false;
    orient();
    // If the outline does not touch itself, no two ears overlap. If it does, they may: for example, if a hole runs in
    // the same direction as the outline.
    if (clip_ears(ears) && !(touches_ && overlap_themselves(ears))) return true;
    ears.clear();
    return false;
}

/// Returns the sign of the turn at b from a to c, in projection along `axis_`: 1 if counter-clockwise, 0 if collinear.
int Triangulator::plane_turn(int a, int b, int c) const {
    const auto point = [&](int i) -> const Vec3d& { return points_[static_cast<std::size_t>(i)]; };
    const int sign = orient2d_filtered(point(a), point(b), point(c), axis_);
    if (sign != undecided) return sign;
    return exact_ ? orient2d_exact(point(a), point(b), point(c), axis_)
                  : integer_turn(point(a), point(b), point(c), axis_);
}

/// Returns the sign of the turn relative to the direction of the polygon: 1 at a convex corner.
int Triangulator::turn(int a, int b, int c) const { return sign_ * plane_turn(a, b, c); }

/// True if corner a is before corner b in projection: it has a smaller x, or equal x and smaller y.
bool Triangulator::before(int a, int b) const {
    const Vec3d &p = points_[static_cast<std::size_t>(a)], &q = points_[static_cast<std::size_t>(b)];
    const int x = first_axis(axis_), y = second_axis(axis_);
    return p[x] < q[x] || (p[x] == q[x] && p[y] < q[y]);
}

bool Triangulator::same_place(int a, int b) const { return !before(a, b) && !before(b, a); }

/// Chooses the axis of projection. Returns false if the polygon is only a segment or a point: any triangulation is
/// right then.
bool Triangulator::find_plane() {
    Vec3d normal, magnitude;
    add_up_cross_products(points_, normal, magnitude);
    exact_ = std::all_of(points_.begin(), points_.end(), [](const Vec3d& p) { return in_expansion_range(p); });
    sign_ = 1;
    // If the normal is zero, as for a symmetric bow tie, the sum of the magnitudes determines the axis.
    axis_ = largest_component(normal == Vec3d{} ? magnitude : normal);
    if (magnitude != Vec3d{}) return true;
    // If the first corner is very far from the others, rounding can make the others equal: test all axes exactly.
    for (axis_ = 2; axis_ >= 0; --axis_) {
        for (int i = 1; i + 1 < count_; ++i)
            if (plane_turn(0, i, i + 1) != 0) return true;
    }
    axis_ = 2;
    return false;
}

/// True if the polygon is convex and no triangle of its fan is degenerate. It is convex if all corners turn in one
/// direction and x has only one local minimum along the outline. A pentagram also turns in one direction, but has two
/// such minima.
bool Triangulator::has_good_fan() const {
    int least = 1, greatest = -1, leftmost = 0;
    bool to_the_left = before(0, count_ - 1);
    for (int i = 0; i < count_; ++i) {
        const int next = i + 1 == count_ ? 0 : i + 1;
        const int corner = plane_turn(i == 0 ? count_ - 1 : i - 1, i, next);
        least = std::min(least, corner);
        greatest = std::max(greatest, corner);
        if (least < 0 && greatest > 0) return false;
        const bool left = before(next, i);
        leftmost += to_the_left && !left;
        to_the_left = left;
    }
    if (leftmost > 1) return false;
    if (least != 0 && greatest != 0) return true;
    for (int i = 1; i + 1 < count_; ++i) {
        if (plane_turn(0, i, i + 1) == 0) return false;
    }
    return true;
}

/// True if hit(i, k) holds for any two of `boxes_` that overlap. Sorts the boxes, and sweeps them from the left.
template <class Hit>
bool Triangulator::any_overlap(Hit hit) {
    std::sort(boxes_.begin(), boxes_.end(), [](const Box& e, const Box& f) { return e.left < f.left; });
    for (auto e = boxes_.begin(); e != boxes_.end(); ++e) {
        for (auto f = e + 1; f != boxes_.end() && f->left <= e->right; ++f) {
            if (f->low <= e->high && e->low <= f->high && hit(e->index, f->index)) return true;
        }
    }
    return false;
}

/// True if two edges cross in a point that is an end of neither. Also sets `touches_`, which is complete only if the
/// result is false.
bool Triangulator::crosses_itself() {
    const auto end = [&](int edge) { return edge + 1 == count_ ? 0 : edge + 1; };
    const int x = first_axis(axis_), y = second_axis(axis_);
    boxes_.clear();
    for (int i = 0; i < count_; ++i) {
        const Vec3d &p = points_[static_cast<std::size_t>(i)], &q = points_[static_cast<std::size_t>(end(i))];
        boxes_.push_back({std::min(p[x], q[x]), std::max(p[x], q[x]), std::min(p[y], q[y]), std::max(p[y], q[y]), i});
    }
    touches_ = false;
    return any_overlap([&](int e, int f) {
        const int a = e, b = end(e), c = f, d = end(f);
        if (b == c || d == a) {  // successive edges touch only at their common corner, except at a spike
            const std::array<int, 3> corner = b == c ? std::array{a, b, d} : std::array{c, a, b};
            touches_ = touches_ || (plane_turn(corner[0], corner[1], corner[2]) == 0 &&
                                    turns_back(corner[0], corner[1], corner[2]));
            return false;
        }
        const int first = plane_turn(a, b, c) * plane_turn(a, b, d), second = plane_turn(c, d, a) * plane_turn(c, d, b);
        touches_ = touches_ || (first <= 0 && second <= 0);
        return first < 0 && second < 0;
    });
}

/// True if the outline turns back on itself at b. The corners a, b and c must be collinear.
bool Triangulator::turns_back(int a, int b, int c) const {
    return same_place(a, b) || same_place(b, c) || before(a, b) == before(c, b);
}

/// True if any two triangles have an area in common. Two triangles have none if an edge of one separates them.
bool Triangulator::overlap_themselves(std::span<const std::int32_t> triangles) {
    const auto corner = [&](int triangle, int k) {
        return triangles[3 * static_cast<std::size_t>(triangle) + static_cast<std::size_t>(k % 3)];
    };
    const int x = first_axis(axis_), y = second_axis(axis_);
    boxes_.clear();
    for (int t = 0; t < static_cast<int>(triangles.size() / 3); ++t) {
        if (turn(corner(t, 0), corner(t, 1), corner(t, 2)) == 0) continue;
        Vec3d low = points_[static_cast<std::size_t>(corner(t, 0))], high = low;
        for (int k = 1; k < 3; ++k) {
            low = min(low, points_[static_cast<std::size_t>(corner(t, k))]);
            high = max(high, points_[static_cast<std::size_t>(corner(t, k))]);
        }
        boxes_.push_back({low[x], high[x], low[y], high[y], t});
    }
    const auto beyond_an_edge = [&](int t, int u) {
        for (int k = 0; k < 3; ++k) {
            const auto outside = [&](int m) { return turn(corner(t, k), corner(t, k + 1), corner(u, m)) <= 0; };
            if (outside(0) && outside(1) && outside(2)) return true;
        }
        return false;
    };
    return any_overlap([&](int t, int u) { return !beyond_an_edge(t, u) && !beyond_an_edge(u, t); });
}

/// Sets `sign_` to the orientation of the polygon, which is the sign of the turn at its leftmost corner.
void Triangulator::orient() {
    int found = 0;
    for (int i = 0; i < count_; ++i) {
        const int corner = plane_turn(i == 0 ? count_ - 1 : i - 1, i, i + 1 == count_ ? 0 : i + 1);
        if (corner == 0 || (found != 0 && !before(i, found - 1))) continue;
        found = i + 1;
        sign_ = corner;
    }
}

bool Triangulator::clip_ears(std::vector<std::int32_t>& ears) {
    const auto n = static_cast<std::size_t>(count_);
    before_.resize(n);
    after_.resize(n);
    turns_.resize(n);
    std::vector<int> not_convex;
    const auto at = [](auto& values, int i) -> auto& { return values[static_cast<std::size_t>(i)]; };
    const auto turn_at = [&](int i) { return static_cast<std::int8_t>(turn(at(before_, i), i, at(after_, i))); };
    for (int i = 0; i < count_; ++i) {
        at(before_, i) = i == 0 ? count_ - 1 : i - 1;
        at(after_, i) = i + 1 == count_ ? 0 : i + 1;
        at(turns_, i) = turn_at(i);
        if (at(turns_, i) <= 0) not_convex.push_back(i);
    }
    not_convex_.build(points_, std::move(not_convex), axis_);
    const auto update = [&](int i, std::int8_t turn) {
        at(turns_, i) = turn;
        if (turn > 0) not_convex_.remove(i);
    };

    // Convex corners to test for being ears: each once, and again when a corner beside it has been clipped. After the
    // last one, all remaining convex corners are tested again, because the corners that blocked them may be gone.
    std::vector<int> to_try;
    std::size_t next = 0;
    int left = count_, some_corner = 0;
    bool clipped = true;
    const auto try_later = [&](int i) {
        if (at(turns_, i) == 1) to_try.push_back(i);
    };
    const auto clip = [&](int b) {
        const int a = at(before_, b), c = at(after_, b);
        ears.insert(ears.end(), {a, b, c});
        at(after_, a) = c;
        at(before_, c) = a;
        update(b, cut_off);
        update(a, turn_at(a));
        update(c, turn_at(c));
        try_later(a);
        try_later(c);
        some_corner = c;
        clipped = true;
        --left;
    };
    while (left > 3) {
        if (next < to_try.size()) {
            const int corner = to_try[next++];
            if (at(turns_, corner) == 1 && is_ear(corner)) clip(corner);
        } else if (clipped) {
            clipped = false;
            to_try.clear();
            next = 0;
            for (int i = 0, corner = some_corner; i < left; ++i, corner = at(after_, corner)) try_later(corner);
        } else {
            // The remaining polygon has no ear: it has a spike, which is a triangle without an area, or crosses itself.
            const int spike = find_spike(some_corner);
            if (spike < 0) return false;
            clip(spike);
        }
    }
    if (at(turns_, some_corner) < 0) return false;
    clip(some_corner);
    return true;
}

/// Returns a corner at which the outline turns back on itself (a spike). If there is none, returns a corner at which
/// the outline is straight, or -1.
int Triangulator::find_spike(int start) const {
    int straight = -1, b = start;
    do {
        const auto i = static_cast<std::size_t>(b);
        const int a = before_[i], c = after_[i];
        if (turns_[i] == 0) {
            if (turns_back(a, b, c)) return b;
            straight = b;
        }
        b = c;
    } while (b != start);
    return straight;
}

/// True if the triangle of the convex corner b and the two corners beside it holds no other corner. It suffices to test
/// corners that are not convex: if any corner lies in the triangle, one that is not convex does.
bool Triangulator::is_ear(int b) const {
    const int a = before_[static_cast<std::size_t>(b)], c = after_[static_cast<std::size_t>(b)];
    return !not_convex_.any_in({a, b, c}, sign_, [&](int r) {
        if (r == a || r == b || r == c) return false;
        // A corner r at the place of a or c does not block the ear by itself: if the outline enters the triangle at r,
        // the corner before or after r shows it.
        if (same_place(r, a) || same_place(r, c)) return false;
        if (same_place(r, b)) return opens_into(r, b);
        return turn(a, b, r) >= 0 && turn(b, c, r) >= 0 && turn(c, a, r) >= 0;
    });
}

/// True if `corner`, at the same place as b, blocks the angle at b: one of the two edges at `corner` leads into that
/// angle, or they run back along both edges at b, so that no area is left between them.
bool Triangulator::opens_into(int corner, int b) const {
    const auto i = static_cast<std::size_t>(b), k = static_cast<std::size_t>(corner);
    const int a = before_[i], c = after_[i], from = before_[k], to = after_[k];
    const auto within = [&](int p) { return turn(a, b, p) > 0 && turn(b, c, p) > 0; };
    const auto along = [&](int p, int q) { return turn(b, p, q) == 0 && before(p, b) == before(q, b); };
    return within(from) || within(to) || (along(a, to) && along(c, from));
}

}  // namespace crumple::io
