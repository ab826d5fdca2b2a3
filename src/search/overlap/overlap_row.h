#pragma once

// Overlap of two bodies: sums over the pairs of their triangles that intersect, and over the triangles of each body
// that lie inside the other (docs/overlap.md). To make surfaces that touch cross as well, the second surface is shifted
// infinitesimally, forward or backward (exact/overlap/face_crossing.h). Components and places of vertices are those of
// scene/closed_surface.h.
//
//   pairs of triangles --signs--> segments in which faces cross, and steps of winding numbers along edges
//   components --one ray each--> winding numbers at their first vertices
//   steps --sorted--> intervals of places with constant winding number --> how often each face counts
//   segments, faces --overlap_sums.h--> numbers, each rounded once
//   segments --results/joined_curves.h--> curves
//   segments, vertices inside the other body --overlap_regions.h--> regions

#include <array>
#include <span>
#include <vector>

#include "backends/overlap_kernels.h"
#include "base/cancellation.h"
#include "base/memory_claim.h"
#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "results/joined_curves.h"
#include "results/overlap_output.h"
#include "search/overlap/overlap_sums.h"
#include "search/overlap/overlap_weights.h"
#include "search/overlap/overlap_windings.h"
#include "search/walks/point_walk.h"

namespace crumple {

class OverlapOfBodies {
   public:
    struct Request {
        bool numbers = true;  ///< false: finds only the volume and the relation
        bool gradient = false, windings = false, curves = false, extents = false, regions = false, unions = false;
        double min_volume = 0;  ///< rows whose volume is less, in magnitude, need nothing but the volume
        std::array<int, 2> orientations{1, 1};  ///< for unions: −1 for a body whose faces are to be reversed
        int orientation = 1;                    ///< for a body with itself: −1 if its faces are to be reversed
    };

    /// `kernels`: the backend's kernels for sums, or null if it has none.
    OverlapOfBodies(ParallelFor& workers, const OverlapKernels* kernels, MemoryMeter& meter, Cancellation& cancellation)
        : workers_(workers),
          kernels_(kernels),
          meter_(meter),
          cancellation_(cancellation),
          memory_(meter),
          sums_(workers, kernels, cancellation) {}

    /// Sets what a device has found for the pairs of the following call. Crossings are empty if it has decided none.
    void set_on_device(const RowOnDevice& row) { sums_.on_device = row; }

    /// Returns the overlap of a and b; call once. `pairs`: all pairs of triangles of a and b that have a common point,
    /// and possibly others, sorted. Sums are relative to `origin`.
    OverlapRow find(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs, const Vec3d& origin,
                    const Request& request);

    /// Returns the result for surfaces of which at least one is not closed. Of the numbers it has only the contact area
    /// and the torque point, `origin`. It has curves if they are requested.
    OverlapRow find_open(const PlacedSurface& a, const PlacedSurface& b, std::span<const Pair> pairs,
                         const Vec3d& origin, const Request& request);

    /// Returns the overlap of a body with itself, ½ ∫ (w² − w) dx for its winding number w, and its volume. `pairs`:
    /// all pairs of different triangles that have a common point, in both orders.
    OverlapRow find_self(const PlacedSurface& body, std::span<const Pair> pairs, const Vec3d& origin,
                         const Request& request);

    /// Adds depths to a row with closed surfaces that find() has returned, as the query requests. `tree`: trees of both
    /// surfaces.
    void add_depths(const OverlapQuery& query, const std::array<const SurfaceTree*, 2>& tree, OverlapRow& row);

    /// Returns true if some number needed rational arithmetic.
    bool was_exact() const { return was_exact_ || sums_.was_exact(); }

   private:
    /// For each surface the steps of the other one's winding number along it, under one shift.
    using ShiftedSteps = std::array<WindingSteps, 2>;

    OverlapRow find(const Request& request);
    /// Decides how the pairs of triangles cross. Stores the steps of both shifts if `gradient`, else only those of the
    /// forward shift.
    void cross_pairs(bool gradient);
    bool some_pair_meets();
    /// Makes the intervals in which winding numbers are constant.
    void find_windings(bool gradient);
    bool in_range() const { return sums_.surfaces.in_range(); }
    const PlacedSurface& body(std::size_t side) const { return *sums_.surfaces.surface[side]; }
    const ClosedSurface& topology(std::size_t side) const { return *body(side).surface; }
    const WindingSteps& steps(std::size_t side) const { return steps_[0][side]; }
    void count_faces();
    /// Adds the faces on whose edge 01 the segment ends, as often as the winding number changes there.
    static void count_crossed_faces(const Segment& segment, std::array<std::vector<CountedFace>, 2>& faces);
    double contact_area();
    bool is_inside(std::size_t side) const;
    OverlapRelation relate(const OverlapNumbers& numbers);
    bool has_volume_of(std::size_t side, const Scaled& volume);
    double volume_of_body();
    RoundedSum volume_with(const std::array<int, 2>& times);
    void add_unions(const std::array<int, 2>& orientations, OverlapRow& row);
    /// Returns empty sums over the same bodies, for a volume only.
    OverlapSums sums_of_surfaces() const;
    /// Returns the vertices inside the other surface, in the order of places.
    std::vector<VertexWinding> inside_vertices(std::size_t side) const;
    /// Returns them in the order of vertices.
    std::vector<VertexWinding> windings(std::size_t side) const;

    /// Segments of the forward shift, and links from index `links` on (results/joined_curves.h).
    struct ForwardSegments {
        std::vector<Segment> segments;
        std::size_t links = 0;
    };
    ForwardSegments forward_segments() const;
    FaceReader face_reader() const;
    /// Returns the curves (overlap_curves.cpp). Torques are about `point`.
    std::vector<OverlapCurve> curves(const Vec3d& point);
    /// Returns the regions (overlap_region_numbers.cpp), and sets the region of each segment. `add_sums`: makes the
    /// sums of the row from those of the regions; none may have been requested before.
    std::vector<OverlapRegion> regions(bool add_sums);
    /// True if the sums of all regions add up to those of the row: if both shifts have the same segments.
    bool regions_have_all_sums() const;
    OverlapExtent extent(const Vec3d& normal);

    // Gradient (overlap_gradient.cpp):
    template <class Number, class Wanted>
    WeightedFaces<Number> weigh(std::size_t side, Wanted wanted) const;
    /// Divisor of the sums of a gradient. 12 = 2 · 3 · 2: the length of a face's normal is twice its area, weights are
    /// three times a mean over the face, and the terms of both shifts are added. 24 for a body with itself, whose
    /// overlap has a factor ½.
    int divisor() const { return self_ ? 24 : 12; }
    std::vector<VertexVector> gradient(std::size_t side);
    std::vector<VertexVector> rational_gradient(std::size_t side, const std::vector<std::int32_t>& vertices);

    ParallelFor& workers_;
    const OverlapKernels* kernels_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    MemoryClaim memory_;  ///< memory of the steps, segments and faces below, counted by the meter
    bool was_exact_ = false;
    std::span<const Pair> pairs_;
    bool surfaces_meet_ = false;
    std::vector<Segment> links_;         ///< segments without length; they connect curves (joined_curves.h)
    std::vector<Pair> coplanar_;         ///< pairs of coplanar triangles; for a body with itself, each pair once
    int self_ = 0;                       ///< for a body with itself: its orientation; else 0
    std::array<ShiftedSteps, 2> steps_;  ///< by shift: forward, and for gradients also backward
    OverlapSums sums_;
    ForwardSegments forward_;                      ///< if they are needed
    std::vector<std::int32_t> region_of_segment_;  ///< of the forward shift; empty without regions
};

}  // namespace crumple
