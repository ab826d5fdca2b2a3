#pragma once

// Terms of the integrals over an overlap (pair_terms.h) in double words with error bounds (enclosed.h), from corners of
// faces. Requires coordinates in the range of double words. Compiled for host and device.

#include <limits>

#include "exact/overlap/crossing_edge.h"
#include "exact/overlap/enclosed.h"
#include "exact/overlap/pair_terms.h"

namespace crumple {

/// Returns the parameter in [0, 1] at which the edge from → to crosses the plane of a face. The error bound is infinite
/// if the parameter is too uncertain to be useful in sums, or so small that products might underflow.
CRUMPLE_HD inline Enclosed filtered_parameter(const Vec3d& from, const Vec3d& to, const FaceCorners& q) {
    constexpr double largest_error = 0x1p-80, least_parameter = 0x1p-250;
    const Vec3<Enclosed> normal = cross(enclosed_difference(q[1], q[0]), enclosed_difference(q[2], q[0]));
    const Enclosed before = dot(normal, enclosed_difference(from, q[0])),
                   after = dot(normal, enclosed_difference(to, q[0]));
    const Enclosed parameter = before / (before - after);
    if (parameter.error <= largest_error && parameter.magnitude() >= least_parameter) return parameter;
    return {{0, 0}, std::numeric_limits<double>::infinity()};
}

/// Adds the terms of a face that counts `times` times.
CRUMPLE_HD inline void add_face_terms(const FaceCorners& p, std::int32_t times, const Vec3d& origin,
                                      VolumeTerms<Enclosed>& terms) {
    const Vec3<Enclosed> x = enclosed_difference(p[0], origin), y = enclosed_difference(p[1], origin),
                         z = enclosed_difference(p[2], origin);
    terms.add(Enclosed(times) * dot(x, cross(y - x, z - x)), x + y + z);
}

/// Adds the terms of a segment from `start` to `end`, which are relative to the origin, in the faces a and b. If the
/// segment has no length (crossing_edge.h), its cones are 0 and left out.
CRUMPLE_HD inline void add_segment_terms(const Segment& segment, const FaceCorners& a, const FaceCorners& b,
                                         const Vec3<Enclosed>& start, const Vec3<Enclosed>& end, const Vec3d& origin,
                                         VolumeTerms<Enclosed>& terms, bool has_length = true) {
    const auto add_cone = [&](const auto& x, const auto& y, const auto& z, int times) {
        terms.add(Enclosed(times) * dot(x, cross(y, z)), x + y + z);
    };
    const auto add_edge = [&](const SegmentEnd& of, const Vec3<Enclosed>& at) {
        const FaceCorners& p = of.side ? b : a;
        if (of.edge == 1) add_cone(enclosed_difference(p[0], origin), at, enclosed_difference(p[2], origin), of.jump);
    };
    if (has_length) {
        add_cone(enclosed_difference(a[0], origin), start, end, 1);
        add_cone(enclosed_difference(b[0], origin), end, start, 1);
    }
    add_edge(segment.start, start);
    add_edge(segment.end, end);
}

/// Terms of several segments.
struct SegmentTerms {
    VolumeTerms<Enclosed> volume;
    CurveTerms<Enclosed> curves;
};

/// Adds the terms of a segment, as often as it counts. Returns false, and adds nothing, if an end is too uncertain.
/// `numbers`: false if only the volume is needed.
CRUMPLE_HD inline bool add_if_certain(const Segment& segment, const FaceCorners& a, const FaceCorners& b,
                                      const Vec3d& origin, bool numbers, SegmentTerms& terms) {
    Vec3<Enclosed> end[2];
    for (int e = 0; e < 2; ++e) {
        const CrossingEdge edge(a, b, e == 0 ? segment.start : segment.end);
        end[e] = enclosed_difference(edge.from, origin);
        if (edge.is_vertex()) continue;
        const Enclosed t = filtered_parameter(edge.from, edge.to, edge.face);
        if (!(t.error <= 1)) return false;
        end[e] = end[e] + t * enclosed_difference(edge.to, edge.from);
    }
    if (segment.in_volume) add_segment_terms(segment, a, b, end[0], end[1], origin, terms.volume);
    if (!numbers || segment.times == 0) return true;
    CurveTerms<Enclosed> once;
    once.add(end[0], end[1]);
    for (int times = 0; times < segment.times; ++times) terms.curves.add(once);
    return true;
}

}  // namespace crumple
