#pragma once

// Terms of the sums over an overlap (exact/overlap/pair_terms.h) in double-double arithmetic with error bounds. Host
// only.

#include "exact/overlap/enclosed_parameter.h"
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
        add_face_terms(p, times, surfaces_.origin, terms);
    }
    void add(const Segment& segment, VolumeTerms<Enclosed>& terms) const {
        const CrossingEdge start = crossing_edge(surfaces_, segment, segment.start),
                           end = crossing_edge(surfaces_, segment, segment.end);
        const bool has_length = !has_no_length(start, end);
        if (!has_length && segment.start.edge != 1 && segment.end.edge != 1) return;
        add_segment_terms(segment, surfaces_.corners_a(segment), surfaces_.corners_b(segment), at(start), at(end),
                          surfaces_.origin, terms, has_length);
    }
    void add(const Segment& segment, CurveTerms<Enclosed>& terms) const {
        const CrossingEdge start = crossing_edge(surfaces_, segment, segment.start),
                           end = crossing_edge(surfaces_, segment, segment.end);
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
