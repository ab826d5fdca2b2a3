#include "exact/impact/exact_min_distance.h"

#include <array>
#include <optional>
#include <type_traits>
#include <utility>

#include "exact/impact/paths.h"
#include "exact/impact/roots.h"

namespace crumple {
namespace {

// The squared distance of two features is the least of several quotients over / under. There is one for each pair of
// their sub-features: the squared distance between the points at which a common perpendicular meets the two. If the
// perpendicular misses one of them, a condition is negative or the divisor is 0, and the quotient does not count.
//
// Each function below calls look(over, under, conditions) for each quotient of its features. Coordinates are integers
// at one time, or polynomials in t. `conditions` is a function, because conditions are seldom needed.

template <class T, class Look>
void vertex_quotient(const Vec3<T>& p, const Vec3<T>& q, Look look) {
    const Vec3<T> way = q - p;
    T one;
    if constexpr (std::is_same_v<T, Polynomial>) {
        one = Polynomial({1});
    } else {
        one = 1;
    }
    look(dot(way, way), one, [] { return std::array<T, 0>{}; });
}

/// Visits the quotient of p and the line through a and b, but not those of p and the ends.
template <class T, class Look>
void line_quotient(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, Look look) {
    const Vec3<T> edge = b - a, way = p - a, normal = cross(edge, way);
    look(dot(normal, normal), dot(edge, edge), [&] { return std::array{dot(way, edge), dot(b - p, edge)}; });
}

template <class T, class Look>
void vertex_edge_quotients(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, Look look) {
    line_quotient(p, a, b, look);
    vertex_quotient(p, a, look);
    vertex_quotient(p, b, look);
}

template <class T, class Look>
void vertex_face_quotients(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c, Look look) {
    const Vec3<T> normal = cross(b - a, c - a);
    const T volume = dot(normal, p - a);
    look(volume * volume, dot(normal, normal), [&] {
        const auto inside = [&](const Vec3<T>& from, const Vec3<T>& to) {
            return dot(normal, cross(to - from, p - from));
        };
        return std::array{inside(a, b), inside(b, c), inside(c, a)};
    });
    const std::array corner{a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
        line_quotient(p, corner[i], corner[(i + 1) % 3], look);
        vertex_quotient(p, corner[i], look);
    }
}

template <class T, class Look>
void edge_edge_quotients(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c, const Vec3<T>& d, Look look) {
    const Vec3<T> first = b - a, second = d - c, way = c - a, normal = cross(first, second);
    const T volume = dot(normal, way), length = dot(normal, normal);
    look(volume * volume, length, [&] {
        // Parameters of the perpendicular's ends on both edges, each times `length`.
        const T on_first = dot(cross(way, second), normal), on_second = dot(cross(way, first), normal);
        return std::array{on_first, length - on_first, on_second, length - on_second};
    });
    for (const auto& end : {a, b}) line_quotient(end, c, d, look);
    for (const auto& end : {c, d}) {
        line_quotient(end, a, b, look);
        for (const auto& other : {a, b}) vertex_quotient(end, other, look);
    }
}

/// Nonnegative number over / under.
struct NonnegativeRatio {
    Integer over, under = 1;

    friend bool operator<(const NonnegativeRatio& x, const NonnegativeRatio& y) {
        return x.over * y.under < y.over * x.under;
    }
};

/// Returns the square of x in units of 4^exponent.
NonnegativeRatio squared(double x, int exponent) {
    const Binary binary(x);
    const Integer square = Integer(binary.mantissa) * binary.mantissa;
    const int places = binary.mantissa == 0 ? 0 : 2 * (binary.exponent - exponent);
    return places < 0 ? NonnegativeRatio{square, Integer(1) << -places} : NonnegativeRatio{square << places};
}

/// Returns the impact at the first root of over / under = limit in [0, 1] at which no condition is negative; none if
/// the equation holds at all times.
template <class Conditions>
Impact first_root(const Polynomial& over, const Polynomial& under, Conditions conditions,
                  const NonnegativeRatio& limit) {
    const Polynomial excess = Polynomial({limit.under}) * over - Polynomial({limit.over}) * under;
    if (excess.zero()) return {};
    for (Root& t : roots_in_unit_interval(excess)) {
        if (t.sign(under) == 0) continue;
        bool holds = true;
        for (const Polynomial& condition : conditions()) holds = holds && t.sign(condition) >= 0;
        if (holds) return {true, t.rounded_down(), false};
    }
    return {};
}

/// Returns the sign of p right after t.
int sign_after(Root& t, Polynomial p) {
    for (; !p.zero(); p = p.derivative()) {
        if (const int sign = t.sign(p)) return sign;
    }
    return 0;
}

/// Returns the impact at the first time in [0, 1) right after which over / under < limit and no condition is negative.
template <class Conditions>
Impact first_fall(const Polynomial& over, const Polynomial& under, Conditions conditions,
                  const NonnegativeRatio& limit) {
    const Polynomial excess = Polynomial({limit.under}) * over - Polynomial({limit.over}) * under;
    const auto falls = [&](Root& t) {
        if (sign_after(t, excess) >= 0 || sign_after(t, under) == 0) return false;
        for (const Polynomial& condition : conditions()) {
            if (sign_after(t, condition) < 0) return false;
        }
        return true;
    };
    if (excess.zero()) return {};
    Root start(Dyadic{0, 0});
    if (falls(start)) return {true, 0, true};
    const Polynomial from_end({-1, 1});
    for (Root& t : roots_in_unit_interval(excess)) {
        if (t.sign(from_end) < 0 && falls(t)) return {true, t.rounded_down(), false};
    }
    return {};
}

/// Decides when features first come within the minimum distance. quotients(points, look) calls `look` for each of their
/// quotients, for points of either type.
template <std::size_t N, class Quotients>
Impact first_within(const std::array<MovingPoint, N>& points, const MinDistance& separation, Quotients quotients) {
    const int exponent = common_exponent(points);
    std::array<Vec3<Integer>, N> start;
    for (std::size_t i = 0; i < N; ++i) start[i] = in_units(points[i].start, exponent);
    std::optional<NonnegativeRatio> least;
    quotients(start, [&](const Integer& over, const Integer& under, auto conditions) {
        const NonnegativeRatio square{over, under};
        if (under == 0 || (least && !(square < *least))) return;
        for (const Integer& condition : conditions()) {
            if (condition < 0) return;
        }
        least = square;
    });

    const NonnegativeRatio share = squared(separation.share, 0);
    const NonnegativeRatio shared{share.over * least->over, share.under * least->under};
    NonnegativeRatio limit = squared(separation.distance, exponent);
    if (limit < shared) limit = shared;
    const bool within = !(limit < *least);
    if (within && !separation.approaching_only) return {true, 0, true};
    if (within && least->over == 0) return {};  // nothing is closer than contact

    Impact first;
    quotients(paths(points, exponent), [&](const Polynomial& over, const Polynomial& under, auto conditions) {
        const Impact impact =
            within ? first_fall(over, under, conditions, *least) : first_root(over, under, conditions, limit);
        if (impact.meets && (!first.meets || impact.toi < first.toi || impact.start)) first = impact;
    });
    return first;
}

}  // namespace

Impact vertex_face(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                   const MinDistance& separation) {
    return first_within(std::array{p, a, b, c}, separation,
                        [](const auto& at, auto look) { vertex_face_quotients(at[0], at[1], at[2], at[3], look); });
}

Impact edge_edge(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                 const MinDistance& separation) {
    return first_within(std::array{a, b, c, d}, separation,
                        [](const auto& at, auto look) { edge_edge_quotients(at[0], at[1], at[2], at[3], look); });
}

Impact vertex_edge(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MinDistance& separation) {
    return first_within(std::array{p, a, b}, separation,
                        [](const auto& at, auto look) { vertex_edge_quotients(at[0], at[1], at[2], look); });
}

Impact vertex_vertex(const MovingPoint& p, const MovingPoint& q, const MinDistance& separation) {
    return first_within(std::array{p, q}, separation,
                        [](const auto& at, auto look) { vertex_quotient(at[0], at[1], look); });
}

}  // namespace crumple
