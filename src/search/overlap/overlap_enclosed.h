#pragma once

// Terms of the sums over an overlap (exact/overlap/pair_terms.h) in double-double arithmetic with error bounds. Host
// only.

#include <array>

#include "exact/overlap/enclosed_parameter.h"
#include "exact/overlap/pair_terms.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

inline Enclosed enclosed_parameter(const CrossingEdge& edge) {
    return enclosed_parameter(edge.from, edge.to, edge.face);
}

/// Adds terms in double-double arithmetic, for bodies whose coordinates are in its range.
class EnclosedTerms {
   public:
    explicit EnclosedTerms(const SurfacePair& surfaces) : surfaces_(surfaces) {}

    void add_face(const FaceCorners& p, std::int32_t times, VolumeTerms<Enclosed>& terms) const {
        const Vec3<Enclosed> x = at(p[0]), y = at(p[1]), z = at(p[2]);
        terms.add(Enclosed(times) * dot(x, cross(y - x, z - x)), x + y + z);
    }
    void add(const Segment& segment, VolumeTerms<Enclosed>& terms) const {
        const CrossingEdge start(surfaces_, segment, segment.start), stop(surfaces_, segment, segment.end);
        const bool has_length = !has_no_length(start, stop);
        if (!has_length && segment.start.edge != 1 && segment.end.edge != 1) return;
        const std::array<Vec3<Enclosed>, 2> end{at(start), at(stop)};
        const std::array<FaceCorners, 2> face{surfaces_.corners_a(segment), surfaces_.corners_b(segment)};
        const std::array<Vec3<Enclosed>, 2> first{at(face[0][0]), at(face[1][0])};
        const auto add_cone = [&](const auto& x, const auto& y, const auto& z, int times) {
            terms.add(Enclosed(times) * dot(x, cross(y, z)), x + y + z);
        };
        if (has_length) {
            add_cone(first[0], end[0], end[1], 1);
            add_cone(first[1], end[1], end[0], 1);
        }
        for (std::size_t e = 0; e < 2; ++e) {
            const SegmentEnd& of = e == 0 ? segment.start : segment.end;
            if (of.edge == 1) add_cone(first[of.side], end[e], at(face[of.side][2]), of.jump);
        }
    }
    void add(const Segment& segment, CurveTerms<Enclosed>& terms) const {
        const CrossingEdge start(surfaces_, segment, segment.start), end(surfaces_, segment, segment.end);
        if (!has_no_length(start, end)) terms.add(at(start), at(end));
    }

   private:
    Vec3<Enclosed> at(const Vec3d& p) const { return enclosed_difference(p, surfaces_.origin); }
    Vec3<Enclosed> at(const CrossingEdge& edge) const {
        if (edge.is_vertex()) return at(edge.from);
        return at(edge.from) + enclosed_parameter(edge) * enclosed_difference(edge.to, edge.from);
    }

    const SurfacePair& surfaces_;
};

}  // namespace crumple
