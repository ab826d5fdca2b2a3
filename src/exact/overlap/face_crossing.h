#pragma once

// Decides how a face of one closed surface crosses a face of another, from signs alone. Compiled for host and device.
//
// The second surface is shifted by (e, e², e³), e → 0+, or by the opposite vector. After the shift, surfaces that meet
// also cross. The sign of each determinant is that without the shift or, if that is 0, the sign of the first nonzero
// coefficient of its powers of e (docs/overlap.md). So all crossings of one shift are those of one actual placement in
// general position.
//
// An edge p → p' of one surface crosses a face of the other if p and p' are on different sides of the face's plane, and
// the line from p to p' passes all three edges of the face on the same side. From p to p', the winding number of the
// other surface grows by 1 if p is on the outer side, and falls by 1 if p is on the inner side.

#include <array>
#include <cstddef>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

using FaceCorners = std::array<Vec3d, 3>;

/// Direction in which a surface is shifted.
enum class Shift : std::int8_t { backward = -1, forward = 1 };

inline constexpr std::array both_shifts{Shift::forward, Shift::backward};

CRUMPLE_HD constexpr int sign_of(Shift shift) { return static_cast<int>(shift); }
CRUMPLE_HD constexpr Shift opposite(Shift shift) { return shift == Shift::forward ? Shift::backward : Shift::forward; }

/// Change of the winding number of the other surface along edges 01, 12, 20 of a face: 0 where the edge does not cross
/// the other face.
using EdgeJumps = std::array<int, 3>;

struct FaceCrossing {
    EdgeJumps a{}, b{};
    /// True if both faces are nondegenerate and cross. Exactly two of the six jumps are nonzero then.
    bool segment = false;
};

/// Returns the corner that is alone on its side of a plane which cuts the face.
CRUMPLE_HD constexpr std::size_t lone_corner(const std::array<int, 3>& side) {
    return side[0] == side[1] ? 2 : side[0] == side[2] ? 1 : 0;
}

/// Decides the crossing of two faces a and b under a shift. `Signs` provides, with each sign −1 or 1:
///   has_inside_a, has_inside_b   true if the face has a normal
///   a_side(i)                    side of corner i of a relative to the plane of b; called only if b has a normal
///   b_side(i)                    side of corner i of b relative to the plane of a; called only if a has a normal
///   edges(i, j)                  det(p' − p, q − p, q' − p) for edge i, p → p', of a and edge j, q → q', of b
template <class Signs>
CRUMPLE_HD FaceCrossing cross_faces(Signs& signs) {
    FaceCrossing crossing;
    std::array<int, 3> a{}, b{};
    const auto cut = [](const std::array<int, 3>& side) { return side[0] != side[1] || side[1] != side[2]; };
    const auto cuts = [&](const std::array<int, 3>& side, std::size_t i) { return side[i] != side[(i + 1) % 3]; };
    const auto jump = [](int side) { return side > 0 ? 1 : -1; };
    if (signs.has_inside_b)
        for (std::size_t i = 0; i < 3; ++i) a[i] = signs.a_side(i);
    if (signs.has_inside_b && !cut(a)) return crossing;
    if (signs.has_inside_a)
        for (std::size_t i = 0; i < 3; ++i) b[i] = signs.b_side(i);
    if (signs.has_inside_a && !cut(b)) return crossing;

    if (signs.has_inside_a && signs.has_inside_b) {
        // In each face, the two edges at the corner that is alone on its side cross the plane of the other face. The
        // point at which an edge of a crosses the plane of b lies in b if it lies between the points at which b crosses
        // the plane of a.
        const auto edges_at_lone_corner = [](const std::array<int, 3>& side) {
            const std::size_t lone = lone_corner(side);
            return std::array<std::size_t, 2>{(lone + 2) % 3, lone};
        };
        const auto [i0, i1] = edges_at_lone_corner(a);
        const auto [j0, j1] = edges_at_lone_corner(b);
        const int s00 = signs.edges(i0, j0), s01 = signs.edges(i0, j1), s10 = signs.edges(i1, j0),
                  s11 = signs.edges(i1, j1);
        if (s00 == s01) crossing.a[i0] = jump(a[i0]);
        if (s10 == s11) crossing.a[i1] = jump(a[i1]);
        if (s00 == s10) crossing.b[j0] = jump(b[j0]);
        if (s01 == s11) crossing.b[j1] = jump(b[j1]);
        crossing.segment = (s00 == s01) + (s10 == s11) + (s00 == s10) + (s01 == s11) == 2;
        if (!crossing.segment) crossing = {};
    } else if (signs.has_inside_b) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto s = [&](std::size_t j) { return signs.edges(i, j); };
            if (cuts(a, i) && s(0) == s(1) && s(1) == s(2)) crossing.a[i] = jump(a[i]);
        }
    } else if (signs.has_inside_a) {
        for (std::size_t j = 0; j < 3; ++j) {
            const auto s = [&](std::size_t i) { return signs.edges(i, j); };
            if (cuts(b, j) && s(0) == s(1) && s(1) == s(2)) crossing.b[j] = jump(b[j]);
        }
    }
    return crossing;
}

}  // namespace crumple
