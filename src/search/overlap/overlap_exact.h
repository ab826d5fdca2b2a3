#pragma once

// Terms of the sums over an overlap (exact/overlap/pair_terms.h) in integers. Host only.
//
// Points are in homogeneous coordinates, x / w. Lengths are in units of a power of two that divides all coordinates of
// a term. w is 1 for vertices; for the crossing of an edge with a face it is the difference of the distances of the
// edge's ends from the plane, up to a factor. So terms are integers over products of some w, and no fraction is
// reduced.

#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

class ExactTerms {
   public:
    explicit ExactTerms(const SurfacePair& surfaces) : surfaces_(surfaces) {}

    void add_face(const FaceCorners& p, std::int32_t times, VolumeTotals<RationalSum>& totals) const;
    void add(const Segment& segment, VolumeTotals<RationalSum>& totals) const;
    void add(const Segment& segment, CurveTotals<RationalSum>& totals) const;

   private:
    const SurfacePair& surfaces_;
};

}  // namespace crumple
