#pragma once

// The overlap of two bodies: sums over the pairs of their triangles that intersect, and over the triangles of each that
// lie inside the other (docs/overlap.md).
//
//   pairs --crossings, double words or rationals--> weights of faces, and steps of winding numbers along edges
//   components --a ray each--> winding numbers of their first vertices
//   steps --sorted--> intervals of places whose winding number is constant --> faces inside
//   weights --times cones and normals--> terms --fixed point--> sums, each rounded once where its bound allows, else
//   found
//                                                               again in rationals

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/cancellation.h"
#include "crumple/intersections.h"
#include "exact/overlap/enclosed.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "results/overlap_output.h"
#include "search/overlap_weights.h"
#include "search/overlap_windings.h"

namespace crumple {

inline constexpr std::array both_shifts{Shift::forward, Shift::backward};

/// One surface under one shift: winding numbers of the other at its vertices, and weights of its faces.
template <class Number>
struct ShiftedSurface {
    WindingSteps steps;
    WeightedFaces<Number> weights;

    void clear() {
        steps.clear();
        weights.clear();
    }
};

/// Both surfaces under one shift.
template <class Number>
using ShiftedSurfaces = std::array<ShiftedSurface<Number>, 2>;

class OverlapOfBodies {
   public:
    struct Request {
        bool numbers = true;  ///< otherwise no more than the volume and the relation
        bool gradient = false, windings = false;
        int orientation = 1;  ///< of a body with itself: −1 if its faces are meant to be reversed
    };

    explicit OverlapOfBodies(Cancellation& cancellation) : cancellation_(cancellation) {}

    /// `pairs`: all pairs of triangles of a and b that have a common point, in their order. Sums are about `origin`.
    OverlapRow find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs, const Vec3d& origin,
                    const Request& request);

    /// The overlap of a body with itself: half of what its winding number squared exceeds the winding number by.
    /// `pairs`: all pairs of its triangles that have a common point, in both orders, but for pairs of one triangle.
    OverlapRow find_self(const PlacedSurface& body, std::span<const Pair> pairs, const Vec3d& origin,
                         const Request& request);

    /// The integral of the winding number of a body, correctly rounded.
    double volume_of(const PlacedSurface& body, const Vec3d& origin, int orientation);

    /// Rows of which some number needed rational arithmetic.
    std::int64_t rational_rows() const { return rational_rows_; }

   private:
    struct ExactOverlap {
        std::array<ShiftedSurfaces<Rational>, 2> shifted;  ///< forward, backward
        OverlapTotals<RationalSum> totals;
    };

    OverlapRow find(const Request& request);
    bool in_range() const { return surfaces_[0]->in_range && surfaces_[1]->in_range; }
    const ClosedSurface& topology(std::size_t side) const { return *surfaces_[side]->surface; }
    void add_quickly(const Request& request);
    const ExactOverlap& exact_overlap();
    template <class Number>
    void add_jumps(const Pair& pair, const FaceCrossing& jumps, ShiftedSurfaces<Number>& surfaces) const;
    template <class Number>
    void add_windings(Shift shift, ShiftedSurfaces<Number>& surfaces) const;
    template <class Number, class Sum, class Place>
    void add_faces(ShiftedSurfaces<Number>& surfaces, OverlapTotals<Sum>& totals, Place place) const;
    template <class Sum, class Round>
    bool finish(const OverlapTotals<Sum>& totals, Round round, OverlapNumbers& numbers) const;
    const WindingSteps& steps(std::size_t side) const;
    bool is_inside(std::size_t side) const;
    OverlapRelation relate(const OverlapNumbers& numbers);
    template <class Number, class Wanted>
    WeightedFaces<Number> all_weights(std::size_t side, std::array<ShiftedSurfaces<Number>, 2>& shifted,
                                      Wanted wanted) const;
    /// What the sums of a gradient have to be divided by.
    int divisor() const { return self_ ? 24 : 12; }
    std::vector<VertexVector> gradient(std::size_t side);
    std::vector<VertexVector> rational_gradient(std::size_t side, const std::vector<std::int32_t>& vertices);
    std::vector<VertexWinding> windings(std::size_t side) const;

    Cancellation& cancellation_;
    std::int64_t rational_rows_ = 0;
    // State of the current row:
    std::array<const PlacedSurface*, 2> surfaces_{};
    std::span<const Pair> pairs_;
    Vec3d origin_;
    bool numbers_ = true;
    int self_ = 0;                                    ///< the orientation of a body that is with itself, else 0
    bool crossings_ = false;                          ///< true if any two faces cross
    std::array<ShiftedSurfaces<Enclosed>, 2> quick_;  ///< forward; for gradients also backward
    OverlapTotals<FixedSum> quick_totals_;
    std::optional<ExactOverlap> exact_;
};

}  // namespace crumple
