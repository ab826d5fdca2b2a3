#pragma once

// Area in which two surfaces coincide: the sum, over pairs of faces in one plane, of what they have in common.

#include <span>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "search/overlap_scene.h"

namespace crumple {

struct ContactArea {
    double area = 0;         ///< correctly rounded
    bool was_exact = false;  ///< it needed rational arithmetic
};

/// `pairs`: faces of the first and the second surface that lie in one plane, none of them degenerate. Cost: about a
/// microsecond a pair, far more for those of a sum that double words do not decide.
ContactArea find_contact_area(const OverlapScene& scene, std::span<const Pair> pairs, ParallelFor& workers,
                              Cancellation& cancellation);

}  // namespace crumple
