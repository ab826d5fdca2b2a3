#pragma once

// Area in which two surfaces coincide: the sum of the common areas of pairs of coplanar faces.

#include <span>

#include "base/cancellation.h"
#include "base/memory_claim.h"
#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

struct ContactArea {
    double area = 0;         ///< common area, correctly rounded
    bool was_exact = false;  ///< true if it needed rational arithmetic
};

/// Returns the contact area. `pairs`: coplanar faces of the first and the second surface, none of them degenerate.
/// Cost: some 100 ns per pair, far more if double-double arithmetic cannot round the sum.
ContactArea find_contact_area(const SurfacePair& surfaces, std::span<const Pair> pairs, ParallelFor& workers,
                              Cancellation& cancellation, MemoryMeter& meter);

}  // namespace crumple
