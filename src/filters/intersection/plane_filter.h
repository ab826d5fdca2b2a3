#pragma once

// First filter of `narrow` for one pair of records, and the meaning of its signs (docs/narrow.md). SIMD counterparts:
// backends/cpu/intersections/plane_filter-inl.h and classify-inl.h. Compiled for host and device.

#include "crumple/intersections.h"
#include "filters/intersection/triangle_record.h"

namespace crumple {

/// Options of a query that the filters depend on. `skip_adjacent`: adjacent triangles are apart (Neighbours::skip).
/// `proper`: only pairs count in which an edge of one strictly crosses the interior of the other
/// (IntersectionKind::proper).
struct NarrowPolicy {
    bool skip_adjacent = false;
    bool proper = false;
    friend bool operator==(const NarrowPolicy&, const NarrowPolicy&) = default;
};

inline NarrowPolicy policy_of(Neighbours neighbours, IntersectionKind intersections) {
    return {neighbours == Neighbours::skip, intersections == IntersectionKind::proper};
}

/// Sides of the other triangle's plane on which the corners of a pair of triangles a and b lie, 1 bit per corner.
struct PairSigns {
    unsigned above_a = 0, below_a = 0;  ///< b's corners relative to a's plane, if certain
    unsigned above_b = 0, below_b = 0;  ///< a's corners relative to b's plane, if certain
    /// Corners of a that are also corners of b, and corners of b that are also corners of a.
    unsigned shared_a = 0, shared_b = 0;

    /// True if each corner of one triangle is a corner of the other.
    CRUMPLE_HD bool all_shared() const { return shared_a == 7 || shared_b == 7; }
};

/// Sets the bits of the corners of `other` that certainly lie above and below the plane of `plane`.
CRUMPLE_HD inline void sides_of_plane(const Record& plane, const Record& other, unsigned& above, unsigned& below) {
    for (int k = 0; k < 3; ++k) {
        const float side = plane.x[3] * other.x[k] + plane.y[3] * other.y[k] + plane.z[3] * other.z[k] - plane.c;
        above |= static_cast<unsigned>(side > 1) << k;
        below |= static_cast<unsigned>(side < -1) << k;
    }
}

CRUMPLE_HD inline PairSigns pair_signs(const Record& a, const Record& b) {
    PairSigns s;
    sides_of_plane(a, b, s.above_a, s.below_a);
    sides_of_plane(b, a, s.above_b, s.below_b);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const auto same = static_cast<unsigned>(a.id[i] == b.id[j]);
            s.shared_a |= same << i;
            s.shared_b |= same << j;
        }
    }
    return s;
}

/// Next step for a pair: none, because it is decided (apart, hit); the edge test, then the separating tests (edge); or
/// only the separating tests (open).
enum class NextStep : std::uint8_t { apart, hit, edge, open };

CRUMPLE_HD inline NextStep classify(const PairSigns& s, const NarrowPolicy& policy) {
    const auto single = [](unsigned corners) { return corners == 1 || corners == 2 || corners == 4; };
    const auto next_corner = [](unsigned corner) { return corner == 4 ? 1u : 2 * corner; };
    const bool neighbours = s.shared_b != 0;
    if (neighbours && policy.skip_adjacent) return NextStep::apart;
    // Duplicated faces are left to the exact test.
    if (s.shared_b != 7 && ((s.above_a | s.shared_b) == 7 || (s.below_a | s.shared_b) == 7 ||
                            (s.above_b | s.shared_a) == 7 || (s.below_b | s.shared_a) == 7))
        return NextStep::apart;
    const bool certain = ((s.above_a | s.below_a | s.shared_b) & (s.above_b | s.below_b | s.shared_a)) == 7;
    if (!neighbours) return certain ? NextStep::edge : NextStep::open;
    // A common segment that starts at the shared vertex may end where two edges meet, so that no edge crosses an
    // interior. So for `proper` these pairs stay open.
    if (!certain || policy.proper || !single(s.shared_a) || !single(s.shared_b)) return NextStep::open;
    const bool a1 = s.below_b & next_corner(s.shared_a), b1 = s.below_a & next_corner(s.shared_b);
    return a1 != b1 ? NextStep::hit : NextStep::apart;
}

}  // namespace crumple
