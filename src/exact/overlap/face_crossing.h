#pragma once

// Decides how a face of one closed surface crosses a face of another, from signs alone. Compiled for host and device.
//
// The second surface is shifted by (e, e², e³), e → 0+, or by the opposite of that: then nothing touches, whatever
// meets crosses, and every sign of the shifted placement is that of the placement as given, or, where that is 0, that
// of the first term of the shift (docs/overlap.md). So crossings are those of one actual placement in general position.
//
//   edge p → p' of one surface crosses a face of the other: p and p' are on different sides of the face's plane, and
//   pass its three edges on the same side. On the way the winding number of the other surface grows by 1 if p is on
//   the outer side, and falls by 1 if p is on the inner one.

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
    /// True if both faces have an inside and cross: exactly two of the six numbers are not 0 then.
    bool segment = false;
};

/// `Signs` has, of two faces a and b under a shift, each sign −1 or 1:
///   has_inside_a, has_inside_b   whether the face has a normal
///   a_side(i), b_side(i)         of corner i of a about the plane of b, which has a normal, and the other way round
///   edges(i, j)                  det(p' − p, q − p, q' − p) of edge i, p → p', of a and edge j, q → q', of b
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
        // Two edges of each cross the other's plane, those at the corner that is alone on its side. A point where an
        // edge of a crosses the plane of b lies in b if it lies between the points where b crosses the plane of a.
        const auto edges_at_lone_corner = [](const std::array<int, 3>& side) {
            const std::size_t lone = side[0] == side[1] ? 2 : side[0] == side[2] ? 1 : 0;
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
