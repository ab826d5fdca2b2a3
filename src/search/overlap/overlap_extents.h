#pragma once

// Box and thickness of an overlap or of one of its regions: extremes over the vertices of each body inside the other,
// and over the ends of segments. Computed in double-double arithmetic with error bounds, and in rationals if those are
// too wide. Host only.

#include <array>
#include <span>
#include <vector>

#include "base/cancellation.h"
#include "exact/overlap/enclosed.h"
#include "exact/overlap/exact_crossing.h"
#include "results/overlap_output.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

class ExtentSearch {
   public:
    /// `inside`: by surface, the vertices inside the other one. `segments`: those of closed curves, so that each point
    /// is the end of a segment.
    ExtentSearch(const SurfacePair& surfaces, const std::array<std::span<const VertexWinding>, 2>& inside,
                 std::span<const Segment> segments, Cancellation& cancellation)
        : surfaces_(surfaces), inside_(inside), segments_(segments), cancellation_(cancellation) {}

    /// Returns the extents; all are NaN if there are no vertices and no segments, and the thickness also if the normal
    /// is. Cost: O(n) for n vertices and segments.
    OverlapExtent find(const Vec3d& normal);

    /// True if some number needed rational arithmetic.
    bool was_exact() const { return was_exact_; }

   private:
    /// Greatest of several numbers, enclosed.
    struct Greatest {
        Enclosed least, most;
        bool empty = true;

        void add(const Enclosed& x);
    };

    /// Calls act(point) for each vertex.
    template <class Act>
    void for_each_vertex(Act act) const;
    /// Calls act(from, to, edge) for the end of each segment: the ends of the edge that crosses a face there, and a
    /// function that returns the edge and the face.
    template <class Act>
    void for_each_end(Act act) const;

    void widen_box(const CrossingEdge& edge, OverlapExtent& box);
    double thickness(const Vec3d& normal, const OverlapExtent& box);
    double exact_thickness(const Vec3d& normal, const Greatest& highest, const Greatest& minus_lowest);

    const SurfacePair& surfaces_;
    std::array<std::span<const VertexWinding>, 2> inside_;
    std::span<const Segment> segments_;
    Cancellation& cancellation_;
    bool was_exact_ = false;
};

}  // namespace crumple
