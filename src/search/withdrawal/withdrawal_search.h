#pragma once

// How far a surface has to move along a direction until it is past another one: the last contact.
//
// Pairs of nodes of two trees (projected_tree.h) are visited in the order of the greatest t at which their triangles
// could meet, until that is less than a t that some triangles reach. A filter bounds the t of each pair of triangles;
// only pairs that may reach the greatest t are decided exactly.

#include <cstddef>
#include <cstdint>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// Memory of a search, at most about this many bytes for each face of both surfaces; the caller counts it.
inline constexpr std::size_t projected_bytes_per_face = 96;

/// Work of a search.
struct WithdrawalCounts {
    std::int64_t node_pairs = 0;      ///< pairs of nodes that were visited
    std::int64_t box_overlaps = 0;    ///< pairs of triangles that were tested
    std::int64_t rational_tests = 0;  ///< pairs of triangles that took rational arithmetic
};

/// Returns the greatest t ≥ 0 such that a and b + t · direction have a common point, as the least float64 that is at
/// least t, in units of `direction`; 0 if there is no such t, infinity if it exceeds all float64 numbers. So the
/// surfaces are apart for every greater t. Triangles are closed sets of points, and may be degenerate; the surfaces
/// need not be closed. Exact for all finite coordinates; the result does not depend on the number of threads. Throws
/// Error (invalid_argument) if `direction` is not finite or is 0.
///
/// Cost: O(faces), as both surfaces are projected in each call, and some microseconds for each pair of triangles that
/// meet at about the greatest t.
double find_withdrawal(const PlacedSurface& a, const PlacedSurface& b, const Vec3d& direction, ParallelFor& workers,
                       Cancellation& cancellation, WithdrawalCounts& counts);

}  // namespace crumple
