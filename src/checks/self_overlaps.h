#pragma once

// Overlaps of a shell with itself: the volume and the depth of each (docs/check.md).
//
// The shell is cut along the curves in which it crosses itself. A patch is *covered* if both of its sides are inside
// the shell. The depth of a point of a covered patch is its distance to the other triangles of the shell: those without
// a part of the patch. If the shell consists of two bodies, this is the depth in the other body. Proof: let x be a
// point of the surface of body A that lies inside body B. The segment from x to a point of A's surface outside of B
// meets B's surface. So triangles of A that are not part of the patch are not nearer than B's surface, unless a segment
// from x to them lies inside B, as between two prongs of A in B.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "checks/crossing_places.h"
#include "crumple/io.h"

namespace crumple::checks {

/// Overlap of a shell with itself, bounded by patches and by the curves between them.
struct SelfOverlap {
    std::vector<std::int32_t> places;  ///< indices of its curves' places
    bool is_contact = true;            ///< true if the surfaces touch there, and cover nothing twice
    double volume = 0;                 ///< volume that is covered more than once; with rounding errors
    std::array<double, 2> depth{};     ///< some point is as deep as the first number, no point deeper than the second
};

/// Returns the overlaps of a closed shell with itself, in the order of their first places. Returns nothing if the
/// geometry cannot be resolved in float64: unless the volumes add up to `volume`, which is exact, with a relative error
/// of 10^-6. `outwards`: false if the shell faces inwards. `tolerance`: largest difference of the depth's bounds; it is
/// 0.1 % of the depth if that takes few steps.
std::vector<SelfOverlap> find_self_overlaps(const io::TriangleMesh& shell, const Intersections& found,
                                            std::span<const CrossingPlace* const> places, double volume, bool outwards,
                                            double tolerance);

}  // namespace crumple::checks
