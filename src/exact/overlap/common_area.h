#pragma once

// Computes the area that two coplanar faces have in common, for any type of number that is exact or has an error bound.
//
// In a projection of the plane, with both faces counter-clockwise, the boundary of the common area consists of the
// pieces of each face's edges that lie in the other face. So the area is the sum of the signed areas of the triangles
// that the first corner of a spans with these pieces (cones). Ties are decided as if b were shifted by (e, e²) in the
// projection, e → 0+; the area does not depend on this shift. After the shift, edges that cross do so at one point, and
// the length of an edge inside the other face is a sum over its crossings, in any order.

#include <array>
#include <cstddef>
#include <utility>

#include "exact/overlap/crossing.h"
#include "exact/overlap/enclosed.h"
#include "geometry/predicates.h"

namespace crumple {

/// Projection along an axis, for float64 points in the range of double words: each coordinate is 0 or between 2^-150
/// and 2^150 in magnitude.
struct EnclosedProjection {
    int axis;

    int sign(const Vec3d& p, const Vec3d& q, const Vec3d& r) const {
        return p == r || q == r ? 0 : orient2d(p, q, r, axis);
    }
    /// Returns the determinant (q − p) × (r − p).
    Enclosed value(const Vec3d& p, const Vec3d& q, const Vec3d& r) const {
        const int x = first_axis(axis), y = second_axis(axis);
        const auto difference = [](double to, double from) { return Enclosed::difference(to, from); };
        return difference(q[x], p[x]) * difference(r[y], p[y]) - difference(q[y], p[y]) * difference(r[x], p[x]);
    }
};

namespace detail {

/// Returns the side of the line p → q, 1 (left) or -1, on which a point of this line lies after the point is shifted by
/// (e, e²).
template <class Point>
int side_after_shift(const Point& p, const Point& q, int axis) {
    const int x = first_axis(axis), y = second_axis(axis);
    if (q[y] != p[y]) return q[y] > p[y] ? -1 : 1;
    return q[x] > p[x] ? 1 : -1;
}

}  // namespace detail

/// Adds twice the common area of the projections of a and b, neither of which may be degenerate, to `sum`: calls
/// sum.add(x) to add x, and sum.add_part(x, start, end) to add x · start / (start − end).
template <class Projection, class Corners, class Sum>
void add_common_area(const Projection& projection, Corners a, Corners b, Sum& sum) {
    const std::array<Corners*, 2> faces{&a, &b};
    for (Corners* const face : faces)
        if (projection.sign((*face)[0], (*face)[1], (*face)[2]) < 0) std::swap((*face)[1], (*face)[2]);
    // sign[of][i][j]: side of corner i of face `of` relative to edge j of the other face; 1 is inside, 0 on the edge's
    // line. side[of][i][j]: the same after the shift, never 0.
    int sign[2][3][3], side[2][3][3];
    for (std::size_t of = 0; of < 2; ++of)
        for (std::size_t j = 0; j < 3; ++j) {
            const auto &p = (*faces[1 - of])[j], &q = (*faces[1 - of])[next_corner(j)];
            const int side_on_line = (of == 1 ? 1 : -1) * detail::side_after_shift(p, q, projection.axis);
            bool apart = true;
            for (std::size_t i = 0; i < 3; ++i) {
                sign[of][i][j] = projection.sign(p, q, (*faces[of])[i]);
                side[of][i][j] = sign[of][i][j] != 0 ? sign[of][i][j] : side_on_line;
                apart = apart && sign[of][i][j] <= 0;
            }
            if (apart) return;
        }
    // Returns projection.value() of edge j of the other face and corner i of face `of`.
    using Number = decltype(projection.value(a[0], a[1], a[2]));
    const auto value = [&](std::size_t of, std::size_t i, std::size_t j) {
        if (sign[of][i][j] == 0) return Number(0);
        return projection.value((*faces[1 - of])[j], (*faces[1 - of])[next_corner(j)], (*faces[of])[i]);
    };
    const auto add_edge = [&](std::size_t of, std::size_t i, const Number& cone) {
        const std::size_t next = next_corner(i);
        if (side[of][next][0] > 0 && side[of][next][1] > 0 && side[of][next][2] > 0) sum.add(cone);
        for (std::size_t j = 0; j < 3; ++j) {
            if (side[of][i][j] == side[of][next][j] || side[1 - of][j][i] == side[1 - of][next_corner(j)][i]) continue;
            const bool leaves = side[of][i][j] > 0;
            sum.add_part(leaves ? cone : -cone, value(of, i, j), value(of, next, j));
        }
    };
    add_edge(0, 1, projection.value(a[0], a[1], a[2]));
    for (std::size_t j = 0; j < 3; ++j)
        if (sign[0][0][j] != 0) add_edge(1, j, value(0, 0, j));
}

}  // namespace crumple
