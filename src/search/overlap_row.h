#pragma once

// The overlap of two bodies: sums over the pairs of their triangles that intersect, and over the triangles of each that
// lie inside the other (docs/overlap.md).
//
//   pairs --crossings, double words or rationals--> terms, and steps of winding numbers along the edges they cross
//   components --a ray each--> winding numbers of their first vertices
//   steps --sorted--> intervals of places whose winding number is constant --> faces inside
//   all terms --fixed point--> sums, each rounded once where its bound allows, else found again in rationals

#include <span>
#include <vector>

#include "base/cancellation.h"
#include "crumple/intersections.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/pair_terms.h"
#include "exact/overlap/quick_crossing.h"
#include "scene/closed_surface.h"
#include "scene/placement.h"

namespace crumple {

/// A body where it is.
struct PlacedSurface {
    const ClosedSurface* surface = nullptr;
    const Vec3d* points = nullptr;  ///< by vertex
    Bounds box = no_bounds;
    bool in_range = true;  ///< of double words

    FaceCorners corners(std::int32_t face) const {
        const std::int32_t* c = surface->corners(face);
        return {points[c[0]], points[c[1]], points[c[2]]};
    }
};

/// A winding number that is constant on an interval of places.
struct WindingInterval {
    std::int32_t begin, end, winding;
};

/// Intervals of places of one surface, by the steps of winding numbers at their ends.
class WindingSteps {
   public:
    void clear() { steps_.clear(); }
    void add(std::int32_t begin, std::int32_t end, std::int32_t winding) {
        if (winding == 0) return;
        steps_.push_back({begin, winding});
        steps_.push_back({end, -winding});
    }
    /// What an edge of a face that changes the winding number does.
    void add_jump(const ClosedSurface& surface, std::int32_t face, std::size_t edge, int jump);
    /// The intervals whose winding number is not 0, in their order.
    const std::vector<WindingInterval>& intervals();

   private:
    struct Step {
        std::int32_t place, change;
        friend auto operator<=>(const Step&, const Step&) = default;
    };
    std::vector<Step> steps_;
    std::vector<WindingInterval> intervals_;
};

struct OverlapSums {
    FixedSum volume;                   ///< 18 V
    std::array<FixedSum, 3> moment;    ///< 24 (∫ x − O V)
    std::array<FixedSum, 3> area;      ///< 4 S
    std::array<FixedSum, 3> torque;    ///< −12 T about O
    bool surfaces_meet = false;
    bool windings = false;             ///< whether any vertex has a winding number other than 0
};

class OverlapOfBodies {
   public:
    /// `pairs`: all pairs of triangles of a and b that have a common point.
    void find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs, const Vec3d& origin,
              OverlapSums& sums);

   private:
    void add_pairs(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs, OverlapSums& sums);
    void add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift, WindingSteps& steps);
    void add_inside(const PlacedSurface& of, WindingSteps& steps, OverlapSums& sums);

    Vec3d origin_;
    WindingSteps of_a_, of_b_;
};

}  // namespace crumple
