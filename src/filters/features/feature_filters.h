#pragma once

// Float32 filters, with proven bounds (docs/features.md), that drop pairs of features which are certainly too far
// apart. They come between the filter of triangle pairs (separating_direction.h) and the exact decision. Compiled for
// host and device.
//
// A pair is given by the three vectors from its first point to the others at each time sample (start, and end if
// features move); each component has one rounding error. Coordinates are at most 1, so nothing overflows; slacks cover
// underflow. The place of a point is the projection of its vector on a direction.

#include "crumple/features.h"
#include "filters/features/length.h"
#include "geometry/leaf_frame.h"
#include "geometry/vec.h"

namespace crumple {

/// Errors of places, volumes and normals, relative to the sum of their monomials' magnitudes; the roundings of a
/// comparison are included. `up`: factor that covers the roundings of lengths, products and sums.
inline constexpr float place_error = 10 * unit_roundoff, volume_error = 14 * unit_roundoff,
                       normal_error = 8 * unit_roundoff, up = 1.000002f;
inline constexpr float place_slack = 1e-30f, volume_slack = 1e-32f;

template <int moments>
struct FeatureVectors {
    Vec3f to[moments][3];

    /// Returns upper bounds on the magnitudes of the components of vector i at all times.
    CRUMPLE_HD Vec3f reach(int i) const {
        return moments == 1 ? abs(to[0][i]) : max(abs(to[0][i]), abs(to[moments - 1][i]));
    }
};

/// Returns the side, 1 or -1, on which the second feature lies beyond the first along a direction, or 0 if there is no
/// gap of more than `gap`. `place1` to `place3`: places of the second to the fourth point; that of the first point is
/// 0.
template <FeatureKind kind>
CRUMPLE_HD int side(float place1, float place2, float place3, float gap) {
    if constexpr (kind == FeatureKind::vertex_face) {
        if (min(place1, min(place2, place3)) > gap) return 1;
        return max(place1, max(place2, place3)) < -gap ? -1 : 0;
    }
    if (min(place2, place3) > max(place1, 0.0f) + gap) return 1;
    return max(place2, place3) < min(place1, 0.0f) - gap ? -1 : 0;
}

/// Returns true if a direction separates the features by more than `distance` at each time sample, on the same side.
/// `reach`: sum of seen.reach(i) over the three vectors.
template <FeatureKind kind, int moments>
CRUMPLE_HD bool separates(const Vec3f& direction, const FeatureVectors<moments>& seen, const Vec3f& reach,
                          float distance) {
    const float gap = place_error * dot(abs(direction), reach) + place_slack + distance * up * length(direction);
    const auto side_at = [&](int m) {
        const Vec3f(&to)[3] = seen.to[m];
        return side<kind>(dot(direction, to[0]), dot(direction, to[1]), dot(direction, to[2]), gap);
    };
    const int start = side_at(0);
    return start != 0 && start == side_at(moments - 1);
}

/// Returns the vector from the middle of the first feature to that of the second, times 3 (vertex_face) or 2.
template <FeatureKind kind>
CRUMPLE_HD Vec3f between_middles(const Vec3f (&to)[3]) {
    if constexpr (kind == FeatureKind::vertex_face) return to[0] + to[1] + to[2];
    return to[1] + to[2] - to[0];
}

/// Returns a share of the distance at the start (ImpactQuery::min_distance_share), in [0, 1), rounded up to float32;
/// positive shares stay positive.
CRUMPLE_HD inline float share_to_filter(double share) {
    return share > 0 ? max(static_cast<float>(share) * up, 1e-30f) : 0;
}

/// Returns an upper bound on the features' distance at the start: the least distance between a vertex of one and a
/// vertex of the other, or between their middles. The vectors compared err by less than 6 u (unit_roundoff) times the
/// sum of all magnitudes.
template <FeatureKind kind, int moments>
CRUMPLE_HD float most_at_start(const FeatureVectors<moments>& seen) {
    const Vec3f(&to)[3] = seen.to[0];
    const auto square = [](const Vec3f& v) { return dot(v, v); };
    float least = min(square(to[1]), square(to[2]));
    if constexpr (kind == FeatureKind::vertex_face)
        least = min(least, square(to[0]));
    else
        least = min(least, min(square(to[1] - to[0]), square(to[2] - to[0])));
    const float share = kind == FeatureKind::vertex_face ? 1.0f / 3 : 0.5f;
    least = min(least, share * share * square(between_middles<kind>(to)));
    const Vec3f all = abs(to[0]) + abs(to[1]) + abs(to[2]);
    return std::sqrt(least + least_square) * up + 8 * unit_roundoff * (all.x + all.y + all.z);
}

/// Return vectors along two edges of the face or, for two edges, along these.
template <FeatureKind kind>
CRUMPLE_HD Vec3f first_edge(const Vec3f (&to)[3]) {
    return kind == FeatureKind::vertex_face ? to[1] - to[0] : to[0];
}
template <FeatureKind kind>
CRUMPLE_HD Vec3f second_edge(const Vec3f (&to)[3]) {
    return to[2] - to[kind == FeatureKind::vertex_face ? 0 : 1];
}

/// Returns the component of `way` perpendicular to `edge`, times the squared length of the edge.
CRUMPLE_HD inline Vec3f beside(const Vec3f& way, const Vec3f& edge) {
    return dot(edge, edge) * way - dot(way, edge) * edge;
}

/// Returns, for each component of a x b, the sum of its two products instead of their difference.
CRUMPLE_HD inline Vec3f product_magnitudes(const Vec3f& a, const Vec3f& b) {
    return {a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x};
}

/// Returns true if the four points are coplanar at no time: the Bernstein coefficients of six times their volume, a
/// cubic in time, have one sign. `magnitude`: bound on the sum of the magnitudes of a determinant's monomials.
CRUMPLE_HD inline bool never_in_a_plane(const FeatureVectors<2>& seen, float magnitude) {
    const Vec3f(&p)[3] = seen.to[0], (&q)[3] = seen.to[1];
    const Vec3f start = cross(p[0], p[1]), mixed = cross(p[0], q[1]) + cross(q[0], p[1]), end = cross(q[0], q[1]);
    const float b0 = dot(start, p[2]), b3 = dot(end, q[2]);
    const float b1 = dot(start, q[2]) + dot(mixed, p[2]), b2 = dot(end, p[2]) + dot(mixed, q[2]);  // b1 and b2: times 3
    const float bound = volume_error * magnitude + volume_slack;
    const float least = min(min(b0, b3), min(b1, b2) * (1.0f / 3)), most = max(max(b0, b3), max(b1, b2) * (1.0f / 3));
    return least > bound || most < -bound;
}

/// Returns true if planes prove that static features are further apart than `distance`: the vertex is that far from the
/// face's plane, or the two parallel planes that hold an edge each are that far apart.
template <FeatureKind kind>
CRUMPLE_HD bool plane_is_far(const FeatureVectors<1>& seen, float magnitude, float distance) {
    const Vec3f(&p)[3] = seen.to[0];
    const Vec3f a = first_edge<kind>(p), b = second_edge<kind>(p);
    const Vec3f extent_a = kind == FeatureKind::vertex_face ? abs(p[0]) + abs(p[1]) : abs(p[0]);
    const Vec3f extent_b = kind == FeatureKind::vertex_face ? abs(p[0]) + abs(p[2]) : abs(p[1]) + abs(p[2]);
    const Vec3f n = cross(a, b), off = product_magnitudes(extent_a, extent_b);
    const float most = up * length(n) + normal_error * (off.x + off.y + off.z) + volume_slack;
    return std::abs(dot(cross(p[0], p[1]), p[2])) > distance * up * most + volume_error * magnitude + volume_slack;
}

/// Returns true if the features are certainly further apart than `distance` at all times; false decides nothing. Uses
/// cheap tests, which find most such pairs.
template <FeatureKind kind, int moments>
CRUMPLE_HD bool surely_far_coarse(const FeatureVectors<moments>& seen, float distance) {
    const Vec3f reach[3] = {seen.reach(0), seen.reach(1), seen.reach(2)};
    const Vec3f all = reach[0] + reach[1] + reach[2];
    const float magnitude = dot(product_magnitudes(reach[0], reach[1]), reach[2]);
    Vec3f way = between_middles<kind>(seen.to[0]);
    if constexpr (moments == 1) {
        if (plane_is_far<kind>(seen, magnitude, distance)) return true;
    } else {
        if (distance == 0 && never_in_a_plane(seen, magnitude)) return true;
        way = way + between_middles<kind>(seen.to[1]);
    }
    return separates<kind>(way, seen, all, distance) || separates<kind>(Vec3f{1, 0, 0}, seen, all, distance) ||
           separates<kind>(Vec3f{0, 1, 0}, seen, all, distance) || separates<kind>(Vec3f{0, 0, 1}, seen, all, distance);
}

/// As surely_far_coarse(), but with more directions; for pairs that surely_far_coarse() leaves. Closest points often
/// lie on an edge, so most of these directions are perpendicular to an edge.
template <FeatureKind kind, int moments>
CRUMPLE_HD bool surely_far_fine(const FeatureVectors<moments>& seen, float distance) {
    const Vec3f all = seen.reach(0) + seen.reach(1) + seen.reach(2);
    for (int m = 0; m < moments; ++m) {
        const Vec3f(&to)[3] = seen.to[m];
        const Vec3f way = between_middles<kind>(to), u = first_edge<kind>(to), v = second_edge<kind>(to);
        const auto tells = [&](const Vec3f& direction) { return separates<kind>(direction, seen, all, distance); };
        if (moments == 2 && (tells(way) || tells(cross(u, v)))) return true;
        if (tells(beside(way, u)) || tells(beside(way, v))) return true;
        if (kind == FeatureKind::vertex_face && tells(beside(way, to[2] - to[1]))) return true;
    }
    return false;
}

template <FeatureKind kind, int moments>
CRUMPLE_HD bool surely_far(const FeatureVectors<moments>& seen, float distance) {
    return surely_far_coarse<kind>(seen, distance) || surely_far_fine<kind>(seen, distance);
}

}  // namespace crumple
