#pragma once

// Relative position of two triangles: the corners that they share, the sides of each other's planes on which their
// corners lie, and the order in which their edges meet the common line of the planes. Used by the decision and by
// contacts. Compiled for host and device.

#include <array>

#include "geometry/predicates.h"
#include "geometry/signs.h"
#include "geometry/triangle.h"

namespace crumple {

CRUMPLE_HD constexpr int after(int corner) { return corner == 2 ? 0 : corner + 1; }
CRUMPLE_HD constexpr int before(int corner) { return corner == 0 ? 2 : corner - 1; }
CRUMPLE_HD inline const Vec3d& point(const Triangle& t, int corner) {
    return t.point[static_cast<std::size_t>(corner)];
}

CRUMPLE_HD inline bool in_expansion_range(const Triangle& t) {
    return in_expansion_range(t.point[0]) && in_expansion_range(t.point[1]) && in_expansion_range(t.point[2]);
}

/// Set of a triangle's corners: one mark for each.
using Marks = std::array<bool, 3>;

CRUMPLE_HD constexpr bool all(const Marks& corners) { return corners[0] && corners[1] && corners[2]; }
CRUMPLE_HD constexpr int first(const Marks& corners) { return corners[0] ? 0 : corners[1] ? 1 : 2; }

/// Corners that two triangles share, by vertex ids.
struct Sharing {
    Marks a{}, b{};  ///< true if the corner is also a corner of the other triangle
    int count = 0;   ///< number of distinct ids shared

    CRUMPLE_HD Sharing(const Triangle& s, const Triangle& t) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                const bool same = s.vertex[i] == t.vertex[j];
                a[i] |= same;
                b[j] |= same;
            }
        }
        const auto& id = s.vertex;
        count = a[0] + (a[1] && id[1] != id[0]) + (a[2] && id[2] != id[0] && id[2] != id[1]);
    }
};

/// Sides of a triangle's corners relative to the other's plane: `undecided` until complete() if the filter does not
/// decide them; 0 for shared corners.
struct Sides {
    std::array<int, 3> sign;

    CRUMPLE_HD Sides(const FilteredPlane& plane, const Triangle& t, const Marks& shared) {
        for (std::size_t i = 0; i < 3; ++i) sign[i] = shared[i] ? 0 : plane.side(t.point[i]);
    }
    /// Decides sides unresolved by the filter, for coordinates in the range of expansions (geometry/predicates.h).
    CRUMPLE_HD void complete(const Triangle& plane, const Triangle& t, ExactSigns& signs) {
        const auto& p = plane.point;
        for (std::size_t i = 0; i < 3; ++i) {
            if (sign[i] == undecided) sign[i] = signs.orient_exactly(p[0], p[1], p[2], t.point[i]);
        }
    }

    CRUMPLE_HD int operator[](int i) const { return sign[static_cast<std::size_t>(i)]; }
    CRUMPLE_HD bool certain() const { return sign[0] != undecided && sign[1] != undecided && sign[2] != undecided; }
    CRUMPLE_HD bool zero() const { return sign[0] == 0 && sign[1] == 0 && sign[2] == 0; }
    /// True if a corner is certainly off the plane. Then there is a plane: its triangle is not degenerate.
    CRUMPLE_HD bool prove_plane() const { return is_side(sign[0]) || is_side(sign[1]) || is_side(sign[2]); }

    /// True if all corners but the shared ones certainly lie strictly on one side. At least one corner must not be
    /// shared.
    CRUMPLE_HD bool separated(const Marks& shared = {}) const {
        bool above = true, below = true;
        for (std::size_t i = 0; i < 3; ++i) {
            above &= shared[i] || sign[i] == 1;
            below &= shared[i] || sign[i] == -1;
        }
        return above || below;
    }

   private:
    CRUMPLE_HD static constexpr bool is_side(int s) { return s == 1 || s == -1; }
};

/// Line in which two planes cross, and the edges of both triangles that meet it. Corner 0 of each triangle is alone on
/// the closed positive side of the other's plane; both other corners are on the closed negative side, and no edge at
/// corner 0 lies in the plane. In the direction normal(b) × normal(a) of the corners in this order, `a` meets the line
/// from edge 01 to edge 02, and `b` from edge 02 to edge 01 (P. Guigue, O. Devillers, "Fast and Robust
/// Triangle-Triangle Overlap Test Using Orientation Predicates", 2003).
///
/// To compare two crossings along the line: orient3d(a0, a_i, b0, b_j) is negative if the crossing of edge 0i of `a`
/// comes before that of edge 0j of `b`, and 0 if they are one point. Proof: in coordinates with the line as the first
/// axis and the planes as the others, the determinant is a negative multiple of the distance from the first crossing to
/// the second.
struct CommonLine {
    std::array<Vec3d, 3> a, b;
    std::array<int, 3> side_a, side_b;

    /// Precondition: the planes differ, and neither triangle lies strictly on one side of the other's plane.
    CRUMPLE_HD CommonLine(const Triangle& s, const Triangle& t, const Sides& sides_s, const Sides& sides_t) {
        const bool swap_b = arrange(s, sides_s, a, side_a), swap_a = arrange(t, sides_t, b, side_b);
        if (swap_a) swap_values(a[1], a[2]), swap_values(side_a[1], side_a[2]);
        if (swap_b) swap_values(b[1], b[2]), swap_values(side_b[1], side_b[2]);
    }

   private:
    /// Orders the corners from the lone one on. Returns true if the lone corner is on the negative side, so that the
    /// other triangle has to be turned over.
    CRUMPLE_HD static bool arrange(const Triangle& t, const Sides& side, std::array<Vec3d, 3>& corners,
                                   std::array<int, 3>& sides) {
        for (int i = 0; i < 3; ++i) {
            const int own = side[i], next = side[after(i)], last = side[before(i)];
            const bool lone = own != 0 ? next != own && last != own : next != 0 && next == last;
            if (!lone) continue;
            corners = {point(t, i), point(t, after(i)), point(t, before(i))};
            sides = {own, next, last};
            return own != 0 ? own < 0 : next > 0;
        }
        return false;  // not reached
    }
};

}  // namespace crumple
