#pragma once

// Computes the area that two coplanar faces have in common, for any type of number that is exact or has an error bound.
//
// In a projection of the plane, with both faces counter-clockwise, the boundary of the common area consists of the
// pieces of each face's edges that lie in the other face. So the area is the sum of the signed areas of the triangles
// that an apex spans with these pieces (cones); any point is an apex. Ties are decided as if b were shifted by (e, e²)
// in the projection, e → 0+; the area does not depend on this shift. After the shift, edges that cross do so at one
// point, and the length of an edge inside the other face is a sum over its crossings, in any order.
//
// An edge that two faces traverse in opposite directions adds opposite numbers, in sums over all faces that meet both.
// So such sums can leave it out, wherever its pieces and its crossings would be added.

#include <array>
#include <cstddef>

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

/// Face whose projection is counter-clockwise, and the edges that count: 01, 12, 20.
template <class Point>
struct PlanarFace {
    std::array<Point, 3> corner;
    std::array<bool, 3> counts{true, true, true};
};

/// Signs of corners of two faces relative to each other's edges in a projection, each computed when first needed.
template <class Projection, class Point>
class PlanarSigns {
   public:
    PlanarSigns(const Projection& projection, const PlanarFace<Point>& a, const PlanarFace<Point>& b)
        : projection_(projection), faces_{&a, &b} {}

    /// Returns the side of corner i of face `of` relative to edge j of the other face: 1 is inside, 0 on the edge's
    /// line.
    int sign(std::size_t of, std::size_t i, std::size_t j) {
        int& known = sign_[of][i][j];
        if (known == undecided) known = projection_.sign(from(of, j), to(of, j), faces_[of]->corner[i]);
        return known;
    }
    /// Returns the same after the shift of b: 1 or -1.
    int side(std::size_t of, std::size_t i, std::size_t j) {
        if (const int known = sign(of, i, j)) return known;
        return (of == 1 ? 1 : -1) * detail::side_after_shift(from(of, j), to(of, j), projection_.axis);
    }
    /// True if edge i of a crosses edge j of b, after the shift.
    bool cross(std::size_t i, std::size_t j) {
        return side(0, i, j) != side(0, next_corner(i), j) && side(1, j, i) != side(1, next_corner(j), i);
    }
    /// True if corner i of face `of` lies in the other face, after the shift.
    bool inside(std::size_t of, std::size_t i) {
        return side(of, i, 0) > 0 && side(of, i, 1) > 0 && side(of, i, 2) > 0;
    }
    /// True if an edge has its own face on one closed side, and the other face on the other.
    bool apart() {
        for (std::size_t of = 0; of < 2; ++of)
            for (std::size_t j = 0; j < 3; ++j)
                if (sign(of, 0, j) <= 0 && sign(of, 1, j) <= 0 && sign(of, 2, j) <= 0) return true;
        return false;
    }

    /// Returns Projection::value() of edge j of the other face and corner i of face `of`.
    auto value(std::size_t of, std::size_t i, std::size_t j) {
        using Number = decltype(projection_.value(from(of, j), to(of, j), faces_[of]->corner[i]));
        if (sign(of, i, j) == 0) return Number(0);
        return projection_.value(from(of, j), to(of, j), faces_[of]->corner[i]);
    }

   private:
    const Point& from(std::size_t of, std::size_t j) const { return faces_[1 - of]->corner[j]; }
    const Point& to(std::size_t of, std::size_t j) const { return faces_[1 - of]->corner[next_corner(j)]; }

    const Projection& projection_;
    std::array<const PlanarFace<Point>*, 2> faces_;
    int sign_[2][3][3] = {
        {{undecided, undecided, undecided}, {undecided, undecided, undecided}, {undecided, undecided, undecided}},
        {{undecided, undecided, undecided}, {undecided, undecided, undecided}, {undecided, undecided, undecided}}};
};

/// Adds twice the common area of a and b, as far as edges count, to `sum`: calls sum.add(x) to add x, and
/// sum.add_quotient(x, y) to add x / y.
template <class Projection, class Point, class Sum>
void add_common_area(const Projection& projection, const Point& apex, const PlanarFace<Point>& a,
                     const PlanarFace<Point>& b, PlanarSigns<Projection, Point>& signs, Sum& sum) {
    const auto cone = [&](const PlanarFace<Point>& face, std::size_t i) {
        return projection.value(apex, face.corner[i], face.corner[next_corner(i)]);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        if (a.counts[i] && signs.inside(0, next_corner(i))) sum.add(cone(a, i));
        if (b.counts[i] && signs.inside(1, next_corner(i))) sum.add(cone(b, i));
    }
    // An edge with the values `from` and `to` at its ends has the share from / (from − to) before a crossing. The
    // divisors of the two edges that cross are opposite numbers.
    using Number = decltype(projection.value(apex, apex, apex));
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            if (!a.counts[i] || !b.counts[j] || !signs.cross(i, j)) continue;
            Number rest(0);  // times the divisor of b's edge
            bool divides = false;
            const auto add_part_of = [&](std::size_t of, std::size_t edge, std::size_t other) {
                if (signs.sign(of, edge, other) == 0) return;
                const bool leaves = signs.side(of, edge, other) > 0;
                const Number whole = cone(of == 0 ? a : b, edge);
                if (signs.sign(of, next_corner(edge), other) == 0) return sum.add(leaves ? whole : -whole);
                const Number part = whole * signs.value(of, edge, other);
                rest = leaves == (of == 1) ? rest + part : rest - part;
                divides = true;
            };
            add_part_of(0, i, j);
            add_part_of(1, j, i);
            if (divides) sum.add_quotient(rest, signs.value(1, j, i) - signs.value(1, next_corner(j), i));
        }
}

}  // namespace crumple
