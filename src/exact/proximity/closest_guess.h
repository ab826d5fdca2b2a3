#pragma once

// Float64 guess of the closest points of two features, and the bounds on their distance that it proves. Compiled for
// host and device. The bounds are derived in docs/nearness_algebra.md.
//
// The differences between points of one feature and points of the other are w + s u + t v. For a vertex p and a face a
// b c, w = a - p, u = b - a, v = c - a, and (s, t) is in the triangle s, t ≥ 0, s + t ≤ 1. For edges a b and c d, w = a
// - c, u = b - a, v = c - d, and (s, t) is in the unit square. For a vertex and an edge t is 0, for two vertices s and
// t are 0. Any such difference is at least as long as the distance, and the distance is at least the least projection
// of the differences on any direction. So a guess of the closest points, however obtained, proves an upper and a lower
// bound, and if it is right, both bounds meet.

#include "exact/proximity/double_word_vec.h"
#include "exact/proximity/static_features.h"

namespace crumple {

/// Result of comparing a distance with a DistanceLimit.
enum class Proximity : std::uint8_t { beyond, within, unknown };

namespace detail {

inline constexpr double near_epsilon = 0x1p-53;
/// Exceeds by far the underflow error of a sum of products, and is negligible unless the numbers themselves are as
/// small.
inline constexpr double near_slack = 0x1p-1022;
/// Largest Differences::size. Beyond it products of four numbers might overflow, and nothing is proven.
inline constexpr double largest_size = 0x1p240;

CRUMPLE_HD inline double within_unit(double x) { return x > 0 ? (x < 1 ? x : 1) : 0; }

/// The vectors w, u and v, rounded.
struct Differences {
    FeatureKinds kinds;
    Vec3d w, u{}, v{};
    double size;  ///< sum of |x| + |y| + |z| over w, u and v

    CRUMPLE_HD explicit Differences(const Features& features) : kinds(features.kinds) {
        const auto& [p, q, r, s] = features.point;
        switch (kinds) {
            case FeatureKinds::vertex_face:
                w = q - p, u = r - q, v = s - q;
                break;
            case FeatureKinds::edge_edge:
                w = p - r, u = q - p, v = r - s;
                break;
            case FeatureKinds::vertex_edge:
                w = q - p, u = r - q;
                break;
            case FeatureKinds::vertex_vertex:
                w = p - q;
                break;
        }
        size = length_1(w) + length_1(u) + length_1(v);
    }

    /// True if all differences certainly extend farther than the radius along g. Any g is valid.
    CRUMPLE_HD bool beyond(const Vec3d& g, double radius) const {
        const double along_u = min(0.0, dot(g, u)), along_v = min(0.0, dot(g, v));
        const double least = kinds == FeatureKinds::vertex_face ? min(along_u, along_v) : along_u + along_v;
        const double low = dot(g, w) + least - (8 * near_epsilon * largest(abs(g)) * size + near_slack);
        const Vec3d reach = radius * g;
        return size <= largest_size && low > 0 && low * low > (1 + 32 * near_epsilon) * dot(reach, reach) + near_slack;
    }

    /// True if the difference g, computed as w + s u + t v, is certainly shorter than the radius.
    CRUMPLE_HD bool within(const Vec3d& g, double radius) const {
        const double inner = (1 - 4 * near_epsilon) * radius - (6 * near_epsilon * size + near_slack);
        return size <= largest_size && inner > 0 && inner * inner > (1 + 16 * near_epsilon) * dot(g, g) + near_slack;
    }
};

/// Type and parameters of the closest points, as in ClosestPoints; both may be slightly wrong. For two edges, t is the
/// parameter from c to d, although v is c - d: points of the second edge are subtracted.
struct Guess {
    std::uint8_t type = 0;
    double s = 0, t = 0;
};

CRUMPLE_HD inline Guess guess_edge(const Differences& d) {
    const double place = -dot(d.u, d.w), length = dot(d.u, d.u);
    if (!(place > 0)) return {static_cast<std::uint8_t>(VertexEdgeType::P_E0), 0, 0};
    if (!(place < length)) return {static_cast<std::uint8_t>(VertexEdgeType::P_E1), 1, 0};
    return {static_cast<std::uint8_t>(VertexEdgeType::P_E), within_unit(place / length), 0};
}

/// Guesses from the region of the plane to which the vertex projects (Ericson, Real-Time Collision Detection, 2005,
/// section 5.1.5).
CRUMPLE_HD inline Guess guess_face(const Differences& d) {
    const auto guess = [](VertexFaceType type, double s, double t) {
        return Guess{static_cast<std::uint8_t>(type), s, t};
    };
    using enum VertexFaceType;
    const double uu = dot(d.u, d.u), uv = dot(d.u, d.v), vv = dot(d.v, d.v);
    // Positions along u and v, relative to each corner.
    const double a_u = -dot(d.u, d.w), a_v = -dot(d.v, d.w);
    if (a_u <= 0 && a_v <= 0) return guess(P_T0, 0, 0);
    const double b_u = a_u - uu, b_v = a_v - uv;
    if (b_u >= 0 && b_v <= b_u) return guess(P_T1, 1, 0);
    const double c_u = a_u - uv, c_v = a_v - vv;
    if (c_v >= 0 && c_u <= c_v) return guess(P_T2, 0, 1);
    const double at_c = a_u * b_v - b_u * a_v;
    if (at_c <= 0 && a_u >= 0 && b_u <= 0) return guess(P_E0, within_unit(a_u / uu), 0);
    const double at_b = c_u * a_v - a_u * c_v;
    if (at_b <= 0 && a_v >= 0 && c_v <= 0) return guess(P_E2, 0, within_unit(a_v / vv));
    const double at_a = b_u * c_v - c_u * b_v;
    if (at_a <= 0) {
        const double from_b = b_v - b_u, to_c = c_u - c_v, t = within_unit(from_b / (from_b + to_c));
        return guess(P_E1, 1 - t, t);
    }
    const double sum = at_a + at_b + at_c, s = within_unit(at_b / sum);
    // The limit keeps the point from lying beyond edge b c in exact arithmetic.
    return guess(P_T, s, min(within_unit(at_c / sum), (1 - 8 * near_epsilon) * (1 - s)));
}

/// Guesses for two edges: takes a point of the first edge and the closest point of the second; if that is an end, takes
/// the point of the first edge that is closest to it. Starting from the closest point of the lines, this is exact but
/// for rounding (Ericson, section 5.1.9).
CRUMPLE_HD inline Guess guess_edges(const Differences& d) {
    const double uu = dot(d.u, d.u), uv = dot(d.u, d.v), vv = dot(d.v, d.v), uw = dot(d.u, d.w), vw = dot(d.v, d.w);
    const auto share = [](double place, double length) {
        return place > 0 ? (place < length ? within_unit(place / length) : 1) : 0;
    };
    const auto guess = [&](double s) {
        const double t = share(-(vw + s * uv), vv);
        if (t == 0 || t == 1) s = share(-(uw + t * uv), uu);
        using enum EdgeEdgeType;
        constexpr EdgeEdgeType types[3][3] = {
            {EA0_EB0, EA0_EB1, EA0_EB}, {EA1_EB0, EA1_EB1, EA1_EB}, {EA_EB0, EA_EB1, EA_EB}};
        const auto part = [](double x) { return x == 0 ? 0 : x == 1 ? 1 : 2; };
        return Guess{static_cast<std::uint8_t>(types[part(s)][part(t)]), s, t};
    };
    const double area = uu * vv - uv * uv;
    constexpr double parallel = 0x1p-46;
    if (area > parallel * (uu * vv)) return guess(within_unit((uv * vw - vv * uw) / area));
    // For nearly parallel edges, start from both ends of the first edge.
    const Guess first = guess(0), last = guess(1);
    const Vec3d g = d.w + first.s * d.u + first.t * d.v, h = d.w + last.s * d.u + last.t * d.v;
    return dot(h, h) < dot(g, g) ? last : first;
}

CRUMPLE_HD inline Guess guess_closest(const Differences& d) {
    switch (d.kinds) {
        case FeatureKinds::vertex_face:
            return guess_face(d);
        case FeatureKinds::edge_edge:
            return guess_edges(d);
        case FeatureKinds::vertex_edge:
            return guess_edge(d);
        case FeatureKinds::vertex_vertex:
            break;
    }
    return {};
}

}  // namespace detail

/// True if the distance certainly exceeds the reach. This is the cheapest test, of one direction, from middle to
/// middle. False proves nothing.
CRUMPLE_HD inline bool surely_out_of_reach(const Features& features, const DistanceLimit& reach) {
    const detail::Differences d(features);
    const double share = d.kinds == FeatureKinds::vertex_face ? 1.0 / 3 : 0.5;
    return d.beyond(d.w + share * (d.u + d.v), reach.a + reach.b);
}

}  // namespace crumple
