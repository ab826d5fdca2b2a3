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
#include "exact/overlap/face_crossing.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "geometry/triangle.h"
#include "results/overlap_output.h"
#include "scene/closed_surface.h"
#include "scene/placement.h"

namespace crumple {

/// A body where it is.
struct PlacedSurface {
    const ClosedSurface* surface = nullptr;
    const Vec3d* points = nullptr;  ///< by vertex
    Bounds box = no_bounds;
    bool in_range = true;  ///< of double words

    std::array<Vec3d, 3> corners(std::int32_t face) const {
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
    /// Adds the change of the winding number along an edge of a face.
    void add_jump(const ClosedSurface& surface, std::int32_t face, std::size_t edge, int jump);
    /// Makes the intervals of the steps.
    void finish();
    /// The intervals whose winding number is not 0, in their order.
    const std::vector<WindingInterval>& intervals() const { return intervals_; }

   private:
    struct Step {
        std::int32_t place, change;
        friend auto operator<=>(const Step&, const Step&) = default;
    };
    std::vector<Step> steps_;
    std::vector<WindingInterval> intervals_;
};

class OverlapOfBodies {
   public:
    explicit OverlapOfBodies(Cancellation& cancellation) : cancellation_(cancellation) {}

    /// `pairs`: all pairs of triangles of a and b that have a common point, in their order. Sums are about `origin`.
    OverlapRow find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs, const Vec3d& origin);

    /// Rows whose sums did not tell how they round, so that they were added up in rationals.
    std::int64_t rational_rows() const { return rational_rows_; }

   private:
    void begin();
    void find_windings(const PlacedSurface& a, const PlacedSurface& b);
    void add_quickly(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs);
    OverlapTotals<RationalSum> add_rationally(const PlacedSurface& a, const PlacedSurface& b,
                                              std::span<const Pair> pairs);
    void add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift, WindingSteps& steps);
    void add_jumps(const PlacedSurface& a, const PlacedSurface& b, const Pair& pair, const FaceCrossing& jumps);
    void add_inside(const PlacedSurface& of, const WindingSteps& steps);
    bool is_inside(const PlacedSurface& of, const WindingSteps& steps, const WindingSteps& others) const;
    OverlapRelation relate(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                           const OverlapNumbers& numbers);

    Cancellation& cancellation_;
    std::int64_t rational_rows_ = 0;
    // State of the current row:
    Vec3d origin_;
    bool crossings_ = false;  ///< true if any two faces cross
    WindingSteps of_a_, of_b_;
    OverlapTotals<FixedSum> quick_;
};

}  // namespace crumple
