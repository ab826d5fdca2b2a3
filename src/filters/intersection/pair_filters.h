#pragma once

// Filters of `narrow` for one candidate pair of records, in order (docs/narrow.md). Pairs that they leave undecided go
// to the exact decision. Compiled for host and device; bounds hold with and without fused multiply-adds.

#include "filters/intersection/edge_test.h"
#include "filters/intersection/plane_filter.h"
#include "filters/intersection/separating_plane.h"

namespace crumple {

/// Applies the float32 filters: returns the result of the plane filter, whose signs classify() has turned into `kind`,
/// or, if that decides nothing, applies the further filters.
CRUMPLE_HD inline Verdict filter_in_float(const Record& a, const Record& b, const PairSigns& signs, NextStep kind,
                                          const NarrowPolicy& policy, const PointRows& points, float reach) {
    if (kind == NextStep::apart) return Verdict::apart;
    if (kind == NextStep::hit) return Verdict::collides;
    if (kind == NextStep::edge) {
        const Verdict verdict = edge_test(a, b, signs.below_a, signs.below_b, reach, policy.proper);
        if (verdict != Verdict::undecided) return verdict;
    }
    if (signs.all_shared()) return Verdict::undecided;
    return separated_in_float(a, b, signs.shared_a, signs.shared_b, points, reach) ? Verdict::apart
                                                                                   : Verdict::undecided;
}

/// Returns true if float64 proves that a pair, undecided so far, is apart.
CRUMPLE_HD inline bool filter_in_double(const Record& a, const Record& b, const PairSigns& signs,
                                        const PointRows& points) {
    return !signs.all_shared() && separated_in_double(a, b, signs.shared_a, signs.shared_b, points);
}

/// Applies all filters. `points`: the vertices that the records' ids refer to; `reach`: the largest |coordinate| of a
/// corner in the leaf, the set of triangles that one sweep searches.
CRUMPLE_HD inline Verdict filter_pair(const Record& a, const Record& b, const NarrowPolicy& policy,
                                      const PointRows& points, float reach) {
    const PairSigns signs = pair_signs(a, b);
    const Verdict verdict = filter_in_float(a, b, signs, classify(signs, policy), policy, points, reach);
    if (verdict != Verdict::undecided) return verdict;
    return filter_in_double(a, b, signs, points) ? Verdict::apart : Verdict::undecided;
}

}  // namespace crumple
