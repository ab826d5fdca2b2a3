#pragma once

// First motion along a direction at which the insides of two closed surfaces do not overlap.
//
// The lifts of b (multiples of the direction, exact/withdrawal/sheared_face.h) at which the insides overlap are a union
// of open intervals. The search starts at 0. While some interval contains the current lift, it goes on to the upper end
// of that interval. Intervals come, in this order, from
//   samples       columns (exact/withdrawal/inside_column.h) through some faces of both surfaces: long intervals;
//   pairs         two faces that cross at the current lift: they do so for the open interval of all lifts at which the
//                 insides of both have a common point, and beside the crossing both winding numbers are not 0. Only of
//                 faces that meet no other face of their own surface except at shared vertices and edges;
//   contacts      columns next to all places where faces touch or cross at the current lift;
//   components    a column through each component of a surface, which may be inside the other one without contact.
// If contacts and components have no overlap at the current lift, there is none: a corner of the overlap's convex hull
// is a place where faces touch, or a vertex of a component inside the other surface.
//
// If a contact shows an overlap at the current lift, a column near that place has an interval. The two faces at its end
// are followed to their last contact. There are finitely many such lifts, so the search ends.

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// Work of a search.
struct FirstFreeCounts {
    std::int64_t samples = 0, pairs = 0, contacts = 0;  ///< steps of each kind
};

/// Returns the least t ≥ 0 such that the insides of a and b + t · direction do not overlap, as the least float64 that
/// is at least t; infinity if it exceeds all float64 numbers. The inside of a surface is where its winding number is
/// not 0. Both surfaces must be closed; `direction` is finite, not 0. Exact for all finite coordinates; the result does
/// not depend on the number of threads.
///
/// Cost: O(faces), as both surfaces are projected in each call, then a walk over the pairs of faces that cross for each
/// step, of which there are up to some hundreds; and a millisecond for each place where faces touch at the end. Memory:
/// projected_bytes_per_face (withdrawal_search.h), which the caller counts, and rational numbers, which `meter` counts
/// approximately: those of up to some thousand faces, and of all places where faces touch. Throws
/// MemoryMeter::Exceeded.
double find_first_free(const PlacedSurface& a, const PlacedSurface& b, const Vec3d& direction, ParallelFor& workers,
                       Cancellation& cancellation, MemoryMeter& meter, FirstFreeCounts& counts);

}  // namespace crumple
