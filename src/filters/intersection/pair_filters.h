#pragma once

// The filters of `narrow` for one candidate pair of records, in their order (docs/narrow.md). What they leave undecided
// is for the exact decision. Compiled for host and device; bounds hold with fused multiply-adds and without.

#include "filters/intersection/edge_test.h"
#include "filters/intersection/plane_filter.h"
#include "filters/intersection/separating_plane.h"

namespace crumple {

/// What float32 knows of a pair that the plane filter has left, `kind` by its signs.
CRUMPLE_HD inline Verdict filter_in_float(const Record& a, const Record& b, const PairSigns& signs, PairKind kind,
                                          const NarrowPolicy& policy, const PointRows& points, float reach) {
    if (kind == PairKind::apart) return Verdict::apart;
    if (kind == PairKind::hit) return Verdict::collides;
    if (kind == PairKind::edge) {
        const Verdict verdict = edge_test(a, b, signs.below_a, signs.below_b, reach, policy.proper);
        if (verdict != Verdict::undecided) return verdict;
    }
    if (signs.all_shared()) return Verdict::undecided;
    return separated_in_float(a, b, signs.shared_a, signs.shared_b, points, reach) ? Verdict::apart
                                                                                   : Verdict::undecided;
}

/// Whether float64 knows a pair, undecided so far, to be apart.
CRUMPLE_HD inline bool filter_in_double(const Record& a, const Record& b, const PairSigns& signs,
                                        const PointRows& points) {
    return !signs.all_shared() && separated_in_double(a, b, signs.shared_a, signs.shared_b, points);
}

/// All filters. `points`: the vertices that the records' ids name; `reach`: the leaf's largest |coordinate|.
CRUMPLE_HD inline Verdict filter_pair(const Record& a, const Record& b, const NarrowPolicy& policy,
                                      const PointRows& points, float reach) {
    const PairSigns signs = pair_signs(a, b);
    const Verdict verdict = filter_in_float(a, b, signs, classify(signs, policy), policy, points, reach);
    if (verdict != Verdict::undecided) return verdict;
    return filter_in_double(a, b, signs, points) ? Verdict::apart : Verdict::undecided;
}

}  // namespace crumple
