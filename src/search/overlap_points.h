#pragma once

// Points of faces and segments from the origin of the sums, by type of number: words with bounds, integers, rationals.
// Host only.

#include <algorithm>
#include <array>

#include "exact/overlap/pair_terms.h"
#include "exact/overlap/quick_crossing.h"
#include "exact/overlap/rational_crossing.h"
#include "exact/overlap/segment.h"
#include "search/overlap_windings.h"

namespace crumple {

/// Two bodies, and the origin of the sums over their overlap.
struct OverlapScene {
    std::array<const PlacedSurface*, 2> surface{};
    Vec3d origin;

    bool in_range() const { return surface[0]->in_range && surface[1]->in_range; }
    FaceCorners corners(std::size_t side, std::int32_t face) const { return surface[side]->corners(face); }
    FaceCorners corners_a(const Segment& s) const { return corners(0, s.a); }
    FaceCorners corners_b(const Segment& s) const { return corners(1, s.b); }

    /// The exponent of the largest power of two of which all coordinates are multiples.
    int common_unit() const {
        int unit = common_exponent(std::array{origin});
        for (const PlacedSurface* body : surface)
            for (std::int32_t place = 0; place < body->surface->places(); ++place)
                unit = std::min(unit, common_exponent(std::array{body->points[body->surface->vertex_at(place)]}));
        return unit;
    }
};

/// A face that counts some times.
struct CountedFace {
    std::int32_t face, times;
};

/// The edge at whose point a segment ends, and the face that it crosses.
struct CrossingEdge {
    Vec3d from, to;
    FaceCorners face;

    CrossingEdge(const OverlapScene& scene, const Segment& segment, const SegmentEnd& end) {
        const FaceCorners a = scene.corners_a(segment), b = scene.corners_b(segment);
        const FaceCorners& of = end.side ? b : a;
        face = end.side ? a : b;
        from = of[end.edge];
        to = of[next_corner(end.edge)];
        if (end.vertex >= 0) from = to = of[static_cast<std::size_t>(end.vertex)];
    }
    bool is_vertex() const { return from == to; }
};

inline Vec3<Rational> rational(const Vec3d& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

struct RationalPoints {
    using Number = Rational;
    const OverlapScene& scene;

    Vec3<Rational> at(const Vec3d& p) const { return rational(p) - rational(scene.origin); }
    Vec3<Rational> at(const CrossingEdge& edge) const {
        if (edge.is_vertex()) return at(edge.from);
        const Vec3<Rational> from = at(edge.from);
        return from + share_of_edge(edge.from, edge.to, edge.face) * (at(edge.to) - from);
    }
};

/// The number nearest to a rational one in double words, with its bound.
inline Enclosed enclosed(const Rational& x) {
    const auto high = x.convert_to<double>();
    const Rational rest = x - Rational(high);
    const auto low = rest.convert_to<double>();
    const Rational beyond = abs(rest - Rational(low));
    const TwoTerms value = two_sum(high, low);
    return {value, beyond == 0 ? 0 : (1 + 0x1p-40) * beyond.convert_to<double>() + 0x1p-1070};
}

/// For bodies in the range of double words.
struct EnclosedPoints {
    using Number = Enclosed;
    const OverlapScene& scene;

    Vec3<Enclosed> at(const Vec3d& p) const { return enclosed_difference(p, scene.origin); }
    Vec3<Enclosed> at(const CrossingEdge& edge) const {
        if (edge.is_vertex()) return at(edge.from);
        const FaceCorners& q = edge.face;
        const Vec3<Enclosed> normal = cross(enclosed_difference(q[1], q[0]), enclosed_difference(q[2], q[0]));
        const Enclosed from = dot(normal, enclosed_difference(edge.from, q[0])),
                       to = dot(normal, enclosed_difference(edge.to, q[0]));
        Enclosed share = from / (from - to);
        if (!(share.error <= largest_error) || share.magnitude() < least_share)
            share = enclosed(share_of_edge(edge.from, edge.to, q));
        return at(edge.from) + share * enclosed_difference(edge.to, edge.from);
    }

   private:
    /// Shares with larger bounds are too uncertain to be worth adding; smaller ones might underflow.
    static constexpr double largest_error = 0x1p-80, least_share = 0x1p-250;
};

/// In units of 2^exponent, of which all coordinates are multiples. Segments have to end at vertices.
struct IntegerPoints {
    using Number = Integer;
    const OverlapScene& scene;
    int exponent;

    Vec3<Integer> at(const Vec3d& p) const { return scaled(p, exponent) - scaled(scene.origin, exponent); }
    Vec3<Integer> at(const CrossingEdge& edge) const { return at(edge.from); }
};

/// The terms of a face, and of a segment.
template <class Points, class Terms = VolumeTerms<typename Points::Number>>
void add_face(const Points& points, const FaceCorners& p, std::int32_t times, Terms& terms) {
    using Number = typename Points::Number;
    const Vec3<Number> x = points.at(p[0]), y = points.at(p[1]), z = points.at(p[2]);
    terms.add(Number(times) * dot(x, cross(y - x, z - x)), x + y + z);
}
template <class Points, class Terms = VolumeTerms<typename Points::Number>>
void add_segment(const Points& points, const Segment& segment, Terms& terms) {
    using Number = typename Points::Number;
    const auto add = [&](const Vec3<Number>& x, const Vec3<Number>& y, const Vec3<Number>& z, int times) {
        terms.add(Number(times) * dot(x, cross(y, z)), x + y + z);
    };
    const std::array<Vec3<Number>, 2> end{points.at(CrossingEdge(points.scene, segment, segment.start)),
                                          points.at(CrossingEdge(points.scene, segment, segment.end))};
    const std::array<FaceCorners, 2> face{points.scene.corners_a(segment), points.scene.corners_b(segment)};
    const std::array<Vec3<Number>, 2> first{points.at(face[0][0]), points.at(face[1][0])};
    add(first[0], end[0], end[1], 1);
    add(first[1], end[1], end[0], 1);
    for (std::size_t e = 0; e < 2; ++e) {
        const SegmentEnd& at = e == 0 ? segment.start : segment.end;
        if (at.edge == 1) add(first[at.side], end[e], points.at(face[at.side][2]), at.jump);
    }
}
template <class Points>
void add_curve(const Points& points, const Segment& segment, CurveTerms<typename Points::Number>& terms) {
    terms.add(points.at(CrossingEdge(points.scene, segment, segment.start)),
              points.at(CrossingEdge(points.scene, segment, segment.end)));
}

}  // namespace crumple
