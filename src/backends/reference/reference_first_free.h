#pragma once

// First motion along a direction at which two bodies do not overlap, by brute force in rational arithmetic: the
// reference for search/withdrawal/first_free_search.h.

#include "backends/reference/reference_bodies.h"
#include "base/cancellation.h"

namespace crumple {

/// Returns Overlaps::first_free of two bodies whose surfaces are closed.
///
/// Projects both bodies along the direction, and divides the plane into trapezoids in which no edge of a face ends and
/// no two faces of one body cross. On the lines along the direction through a trapezoid, the winding numbers change at
/// the same faces in the same order. So each pair of an interval inside a and one inside b gives an open interval of t,
/// whose ends are extremes at corners of the trapezoid. The result is the least t that is in none of all these
/// intervals. Cost: O(m² log m + k m) for m edges that cross
/// each other k times; some milliseconds for two tetrahedra, and seconds for bodies of a hundred faces.
double first_free_by_brute_force(const PosedBody& a, const PosedBody& b, const Vec3d& direction,
                                 Cancellation& cancellation);

}  // namespace crumple
