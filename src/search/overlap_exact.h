#pragma once

// The terms of the sums over an overlap in whole numbers (exact/overlap/pair_terms.h). Host only.
//
// Points are homogeneous, x / w in units of a power of two: w is 1 for vertices, and where an edge crosses a face what
// its ends' distances from the plane differ by. So terms are whole numbers over products of some w, and nothing is
// reduced on the way.

#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "search/overlap_points.h"

namespace crumple {

struct ExactPoint {
    Vec3<Integer> x;
    Integer w = 1;  ///< positive
};

class ExactTerms {
   public:
    explicit ExactTerms(const OverlapScene& scene) : scene_(scene), exponent_(scene.common_unit()) {}

    void add_face(const FaceCorners& p, std::int32_t times, VolumeTotals<RationalSum>& totals) const {
        add_cone(at(p[0]), at(p[1]), at(p[2]), times, totals);
    }
    void add(const Segment& segment, VolumeTotals<RationalSum>& totals) const;
    void add(const Segment& segment, CurveTotals<RationalSum>& totals) const;

   private:
    ExactPoint at(const Vec3d& p) const { return {scaled(p, exponent_) - scaled(scene_.origin, exponent_)}; }
    ExactPoint at(const CrossingEdge& edge) const;
    /// Adds the determinant of three points.
    void add_cone(const ExactPoint& p, const ExactPoint& q, const ExactPoint& r, int times,
                  VolumeTotals<RationalSum>& totals) const;
    void add(const Vec3<Integer>& numerators, const Integer& denominator, int degree,
             std::array<RationalSum, 3>& sums) const;

    const OverlapScene& scene_;
    int exponent_;
};

}  // namespace crumple
