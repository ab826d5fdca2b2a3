#pragma once

// Detects closest points that float64 computes without rounding, as for points of a lattice, or features exactly above
// each other. There the closest points are often float64 numbers, and ties occur: a vertex above an edge, a distance
// equal to the radius. Error bounds cannot decide such cases, but exact sums of a few products can. Compiled for host
// and device.

#include "exact/proximity/vectors_from_guess.h"
#include "geometry/predicates.h"

namespace crumple::detail {

/// True if x has no low part and is in the range of expansions: 0, or between 2^-300 and 2^300 in magnitude.
CRUMPLE_HD inline bool plain(DoubleWord x) { return x.low == 0 && in_expansion_range(x.high); }
CRUMPLE_HD inline bool plain(const Vec3dw& p) { return plain(p.x) && plain(p.y) && plain(p.z); }

CRUMPLE_HD inline Expansion<6> exact_dot_product(const Vec3dw& p, const Vec3dw& q) {
    return Expansion<2>(two_product(p.x.high, q.x.high)) + Expansion<2>(two_product(p.y.high, q.y.high)) +
           Expansion<2>(two_product(p.z.high, q.z.high));
}

/// True if g = w + s u + t v exactly.
CRUMPLE_HD inline bool is_combination(const VectorsFromGuess& seen, const Vec3dw& g) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto moved =
            Expansion<2>(two_product(seen.s, seen.u[axis].high)) + Expansion<2>(two_product(seen.t, seen.v[axis].high));
        if ((moved + crumple::exact_difference(seen.w[axis].high, g[axis].high)).sign() != 0) return false;
    }
    return true;
}

/// True if the features are closest exactly at the guess, g is the exact difference there, and `squared` is the exact
/// square of its length. Also false if numbers are not plain().
CRUMPLE_HD_COLD inline bool is_exact(const VectorsFromGuess& seen, const Vec3dw& g, DoubleWord squared) {
    if (!plain(seen.w) || !plain(seen.u) || !plain(seen.v) || !plain(g)) return false;
    if (!in_expansion_range(seen.s) || !in_expansion_range(seen.t) || !is_combination(seen, g)) return false;
    const int along_u = exact_dot_product(g, seen.u).sign(), along_v = exact_dot_product(g, seen.v).sign();
    const bool least = (seen.free > 0 ? along_u == 0 : along_u >= 0) && (seen.free > 1 ? along_v == 0 : along_v >= 0);
    return least && (exact_dot_product(g, g) - Expansion<2>(squared)).sign() == 0;
}

/// Returns the sign of `squared` − x².
CRUMPLE_HD_COLD inline int compare_with_square_exactly(DoubleWord squared, TwoTerms x) {
    return (Expansion<2>(squared) - Expansion<2>(x) * Expansion<2>(x)).sign();
}

}  // namespace crumple::detail
