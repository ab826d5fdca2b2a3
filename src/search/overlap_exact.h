#pragma once

// The terms of the sums over an overlap in whole numbers (exact/overlap/pair_terms.h). Host only.
//
// Points are homogeneous, x / w in units of a power of two that all coordinates of a term are multiples of: w is 1 for
// vertices, and where an edge crosses a face what its ends' distances from the plane differ by. So terms are whole
// numbers over products of some w, and nothing is reduced on the way.

#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "search/overlap_scene.h"

namespace crumple {

class ExactTerms {
   public:
    explicit ExactTerms(const OverlapScene& scene) : scene_(scene) {}

    void add_face(const FaceCorners& p, std::int32_t times, VolumeTotals<RationalSum>& totals) const;
    void add(const Segment& segment, VolumeTotals<RationalSum>& totals) const;
    void add(const Segment& segment, CurveTotals<RationalSum>& totals) const;

   private:
    const OverlapScene& scene_;
};

}  // namespace crumple
