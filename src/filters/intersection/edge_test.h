#pragma once

// Second filter of `narrow`, for one pair of records that share no vertex, that no plane separates, and for which it is
// certain on which side of the other's plane each of the six corners lies. Proof and bound: docs/narrow.md; SIMD
// counterpart: backends/cpu/intersections/edge_test-inl.h. Compiled for host and device.

#include "exact/intersection/verdict.h"
#include "filters/intersection/triangle_record.h"

namespace crumple {

/// Returns the corner that is alone on its side of the plane. `below`: bits of the corners below the plane; never 0 or
/// 7, as the triangle straddles it.
CRUMPLE_HD constexpr int lone_corner(int below) { return (0b00'00'01'10'10'01'00'00 >> 2 * below) & 3; }

/// Returns the order of corners for the edge test: p1, q1, r1, p2, q2, r2 in two bits each. A triangle's lone corner
/// comes first. Its other two are swapped, which flips its plane, if the other triangle's lone corner lies below that
/// plane.
CRUMPLE_HD constexpr int edge_order(int below_a, int below_b) {
    const int p1 = lone_corner(below_b), p2 = lone_corner(below_a);
    // Steps from p to q: 1, or 2 to swap q and r.
    const int turn1 = 1 + (below_a >> p2 & 1), turn2 = 1 + (below_b >> p1 & 1);
    const int q1 = (p1 + turn1) % 3, r1 = (p1 + 3 - turn1) % 3, q2 = (p2 + turn2) % 3, r2 = (p2 + 3 - turn2) % 3;
    return p1 | q1 << 2 | r1 << 4 | p2 << 6 | q2 << 8 | r2 << 10;
}

/// Returns the sign of det(a, b, c) if it is certain, else 0. Each coordinate errs by at most `delta` in addition to
/// its own rounding.
CRUMPLE_HD inline int determinant_sign(const Vec3f& a, const Vec3f& b, const Vec3f& c, float delta) {
    const Vec3f plus{b.y * c.z, b.z * c.x, b.x * c.y}, minus{b.z * c.y, b.x * c.z, b.y * c.x};
    const float value = dot(a, plus - minus), permanent = dot(abs(a), abs(plus) + abs(minus));
    const auto norm1 = [](const Vec3f& p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z); };
    const float A = norm1(a), B = norm1(b), C = norm1(c);
    const float input = A * B + B * C + A * C + 3 * delta * (A + B + C) + 6 * delta * delta;
    const float error = determinant_error * permanent + delta * input + determinant_slack;
    return value > error ? 1 : value < -error ? -1 : 0;
}

/// Decides whether the pair collides, if the bounds allow it. `below_a`: bits of b's corners below a's plane;
/// `below_b`: bits of a's corners below b's plane; `reach`: the largest |coordinate| of a corner in the leaf, the set
/// of triangles that one sweep searches; `proper`: true if only proper intersections count, in which an edge of one
/// triangle strictly crosses the interior of the other (IntersectionKind::proper). Each triangle meets the common line
/// of both planes in an interval. The triangles intersect if these overlap, and properly unless the intervals are
/// equal, as then edges only meet edges. This test does not detect equal intervals, so with `proper` it leaves pairs
/// with overlapping intervals undecided.
CRUMPLE_HD inline Verdict edge_test(const Record& a, const Record& b, unsigned below_a, unsigned below_b, float reach,
                                    bool proper) {
    const int order = edge_order(static_cast<int>(below_a), static_cast<int>(below_b));
    const auto corner = [&](const Record& r, int place) {
        const int k = order >> 2 * place & 3;
        return Vec3f{r.x[k], r.y[k], r.z[k]};
    };
    const Vec3f p1 = corner(a, 0), q1 = corner(a, 1) - p1, r1 = corner(a, 2) - p1;
    const Vec3f p2 = corner(b, 3) - p1, q2 = corner(b, 4) - p1, r2 = corner(b, 5) - p1;
    const float delta = corner_error(reach);
    const int first = determinant_sign(q1, p2, q2, delta), second = determinant_sign(r1, r2, p2, delta);
    if (first > 0 || second > 0) return Verdict::apart;
    return first < 0 && second < 0 && !proper ? Verdict::collides : Verdict::undecided;
}

}  // namespace crumple
