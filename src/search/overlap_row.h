#pragma once

// The overlap of two bodies: sums over the pairs of their triangles that intersect, and over the triangles of each that
// lie inside the other (docs/overlap.md).
//
//   pairs --signs--> segments in which faces cross, and steps of winding numbers along edges
//   components --a ray each--> winding numbers of their first vertices
//   steps --sorted--> intervals of places whose winding number is constant --> how often faces count
//   segments, faces --overlap_sums.h--> numbers, each rounded once
//   segments --results/joined_curves.h--> curves

#include <array>
#include <span>
#include <vector>

#include "backends/overlap_kernels.h"
#include "base/cancellation.h"
#include "base/memory_claim.h"
#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "results/overlap_output.h"
#include "search/overlap_sums.h"
#include "search/overlap_weights.h"
#include "search/overlap_windings.h"

namespace crumple {

class OverlapOfBodies {
   public:
    struct Request {
        bool numbers = true;  ///< otherwise no more than the volume and the relation
        bool gradient = false, windings = false, curves = false;
        int orientation = 1;  ///< of a body with itself: −1 if its faces are meant to be reversed
    };

    /// `kernels`: those of the backend, or null.
    OverlapOfBodies(ParallelFor& workers, const OverlapKernels* kernels, MemoryMeter& meter, Cancellation& cancellation)
        : workers_(workers),
          kernels_(kernels),
          meter_(meter),
          cancellation_(cancellation),
          memory_(meter),
          sums_(workers, kernels, cancellation) {}

    /// The overlap of a and b; called once. `pairs`: all pairs of triangles of a and b that have a common point, in
    /// their order. Sums are about `origin`.
    OverlapRow find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs, const Vec3d& origin,
                    const Request& request);

    /// The same of surfaces of which one is not closed: a row without numbers.
    OverlapRow find_open(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                         const Vec3d& origin, const Request& request);

    /// The overlap of a body with itself, and its volume: half of what its winding number squared exceeds the winding
    /// number by. `pairs`: all pairs of its triangles that have a common point, in both orders, but for pairs of one
    /// triangle.
    OverlapRow find_self(const PlacedSurface& body, std::span<const Pair> pairs, const Vec3d& origin,
                         const Request& request);

    /// Returns true if some number needed rational arithmetic.
    bool was_exact() const { return was_exact_ || sums_.was_exact(); }

   private:
    /// Steps of the winding numbers of the other surface on each, under one shift.
    using ShiftedSteps = std::array<WindingSteps, 2>;

    OverlapRow find(const Request& request);
    /// Decides how pairs cross, and with `gradient` keeps steps of both shifts.
    void cross_pairs(bool gradient);
    /// Makes the intervals in which winding numbers are constant.
    void find_windings(bool gradient);
    bool in_range() const { return sums_.scene.in_range(); }
    const PlacedSurface& body(std::size_t side) const { return *sums_.scene.surface[side]; }
    const ClosedSurface& topology(std::size_t side) const { return *body(side).surface; }
    const WindingSteps& steps(std::size_t side) const { return steps_[0][side]; }
    void count_faces();
    double contact_area();
    bool is_inside(std::size_t side) const;
    OverlapRelation relate(const OverlapNumbers& numbers);
    bool has_volume_of(std::size_t side, const Scaled& volume);
    double volume_of_body();
    /// For further sums about the same bodies: without faces and segments, for volumes.
    OverlapSums sums_of_scene() const;
    std::vector<VertexWinding> windings(std::size_t side) const;

    /// The curves, in overlap_curves.cpp. Torques are about `point`.
    std::vector<OverlapCurve> curves(const Vec3d& point);

    // The gradient, in overlap_gradient.cpp:
    template <class Number, class Wanted>
    WeightedFaces<Number> weigh(std::size_t side, Wanted wanted) const;
    /// What the sums of a gradient have to be divided by.
    int divisor() const { return self_ ? 24 : 12; }
    std::vector<VertexVector> gradient(std::size_t side);
    std::vector<VertexVector> rational_gradient(std::size_t side, const std::vector<std::int32_t>& vertices);

    ParallelFor& workers_;
    const OverlapKernels* kernels_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    MemoryClaim memory_;  ///< steps, segments, faces
    bool was_exact_ = false;
    std::span<const Pair> pairs_;
    std::vector<Segment> links_;  ///< of degenerate faces, for curves: see results/joined_curves.h
    std::vector<Pair> coplanar_;  ///< of these, the faces that lie in one plane; of a body with itself in one order
    int self_ = 0;                ///< the orientation of a body that is with itself, else 0
    std::array<ShiftedSteps, 2> steps_;  ///< forward; for gradients also backward
    OverlapSums sums_;
};

}  // namespace crumple
