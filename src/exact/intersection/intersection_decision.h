#pragma once

// Decides if a pair of triangles collides, without rational arithmetic. Compiled for host and device.
//
// Tests proceed from cheap to expensive. First come float64 filters, which decide nearly all adjacent triangles, also
// in flat meshes. The triangles meet at most in what they share if one of these separates them:
//   - the plane of one triangle: the vertices that the other does not share lie strictly on one side of it;
//   - the line of an edge, seen along an axis: its triangle lies on one side of it, and the vertices that the other
//     triangle does not share lie strictly on the other side;
//   - for one shared vertex, a plane through it: the other two vertices of one triangle lie strictly on one side, those
//     of the other triangle strictly on the other side.
// Then follow the exact sides of the vertices, by expansions where the filter does not decide, and with them the cases:
//   - an interval test on the planes' common line, with closed comparisons;
//   - a shared vertex: both triangles meet the common line in a segment that begins there; only its direction matters;
//   - a shared edge: collides only if both triangles lie in one plane, on the same side of the edge (a fold);
//   - coplanar triangles: the same tests in a projection;
//   - a degenerate triangle: see degenerate_triangles.h.

#include "crumple/intersections.h"
#include "exact/intersection/arrangement.h"
#include "exact/intersection/degenerate_triangles.h"
#include "exact/intersection/verdict.h"
#include "geometry/signs.h"

namespace crumple {

namespace detail {

/// True if, seen along an axis, the line of an edge of `a` certainly has `a` on one closed side, and the corners that
/// `b` does not share strictly on the other.
CRUMPLE_HD inline bool edge_separates(const Triangle& a, const Triangle& b, const Marks& shared_a,
                                      const Marks& shared_b, int axis) {
    const int turn = orient2d_filtered(a.point[0], a.point[1], a.point[2], axis);
    if (turn == undecided) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, opposite = (i + 2) % 3;
        if (shared_a[opposite]) continue;  // shared corners must lie on the edge
        bool separates = true;
        for (std::size_t k = 0; k < 3 && separates; ++k) {
            separates = shared_b[k] || orient2d_filtered(a.point[i], a.point[j], b.point[k], axis) == -turn;
        }
        if (separates) return true;
    }
    return false;
}

/// True if triangles that share corner i of a, which is corner j of b, certainly lie strictly on different sides of a
/// plane through it. Any plane is valid; this one is normal to the difference of the triangles' angle bisectors at the
/// corner.
CRUMPLE_HD inline bool middle_separates(const Triangle& a, const Triangle& b, int i, int j) {
    const Vec3d apex = point(a, i);
    const Vec3d a1 = point(a, after(i)) - apex, a2 = point(a, before(i)) - apex;
    const Vec3d b1 = point(b, after(j)) - apex, b2 = point(b, before(j)) - apex;
    const auto unit = [](const Vec3d& d) { return (1 / std::sqrt(dot(d, d))) * d; };
    const Vec3d normal = (unit(a1) + unit(a2)) - (unit(b1) + unit(b2)), size = abs(normal);
    // Any normal is valid, so its own errors do not count. Four roundings: a difference, a product, two sums.
    const auto side = [&](const Vec3d& d) {
        return certain_sign(dot(normal, d), 5 * epsilon * dot(size, abs(d)) + slack);
    };
    return side(a1) == 1 && side(a2) == 1 && side(b1) == -1 && side(b2) == -1;
}

/// Decision by cases about two nondegenerate triangles, and the signs that the cases need.
template <class Signs>
class Cases {
   public:
    CRUMPLE_HD Cases(const Triangle& a, const Triangle& b, const Sharing& sharing, Signs& signs)
        : a_(a), b_(b), sharing_(sharing), signs_(signs) {}

    /// True if two coplanar triangles meet outside of what they share.
    CRUMPLE_HD_COLD bool overlap_in_plane() {
        const auto& p = a_.point;
        axis_ = FilteredPlane(p).dominant_axis();
        if (turn(p[0], p[1], p[2]) == 0) axis_ = axis_of_area(p[0], p[1], p[2], signs_);
        if (sharing_.count == 0) return !outside_an_edge(a_, b_) && !outside_an_edge(b_, a_);
        return sharing_.count == 1 ? corners_overlap() : folded();
    }

    /// True if an edge of one triangle strictly crosses the inside of the other.
    CRUMPLE_HD_COLD bool cross(const Sides& side_a, const Sides& side_b) {
        return crosses(a_, b_, side_a) || crosses(b_, a_, side_b);
    }

    /// True if two triangles in different planes, without a shared corner, meet. Neither may be strictly on one side of
    /// the other's plane.
    CRUMPLE_HD_COLD bool overlap_on_line(const Sides& side_a, const Sides& side_b) {
        const CommonLine line(a_, b_, side_a, side_b);
        const auto& [a0, a1, a2] = line.a;
        const auto& [b0, b1, b2] = line.b;
        return signs_.orient(a0, a1, b0, b1) <= 0 && signs_.orient(a0, a2, b0, b2) >= 0;
    }

    /// True if two triangles in different planes that share a corner extend from it in the same direction. Each crosses
    /// the other's plane, so it meets the common line in a segment that begins at the shared corner. The side of the
    /// corner after the shared one (or of the last one, if that side is 0) determines the direction of the segment.
    CRUMPLE_HD bool same_direction(const Sides& side_a, const Sides& side_b) const {
        return direction(side_a, first(sharing_.a)) != direction(side_b, first(sharing_.b));
    }

   private:
    CRUMPLE_HD int turn(const Vec3d& p, const Vec3d& q, const Vec3d& r) { return signs_.turn(p, q, r, axis_); }

    CRUMPLE_HD static int direction(const Sides& side, int shared) {
        return side[after(shared)] != 0 ? side[after(shared)] : -side[before(shared)];
    }

    CRUMPLE_HD bool crosses(const Triangle& s, const Triangle& t, const Sides& side) {
        for (int i = 0; i < 3; ++i) {
            if (side[i] * side[after(i)] >= 0) continue;
            const Vec3d p = point(s, i), q = point(s, after(i));
            const int round = signs_.orient(p, q, t.point[0], t.point[1]);
            if (round != 0 && signs_.orient(p, q, t.point[1], t.point[2]) == round &&
                signs_.orient(p, q, t.point[2], t.point[0]) == round)
                return true;
        }
        return false;
    }

    /// True if all of t lies strictly outside one edge of s. Of two disjoint convex polygons, one has such an edge.
    CRUMPLE_HD bool outside_an_edge(const Triangle& s, const Triangle& t) {
        const int inside = turn(s.point[0], s.point[1], s.point[2]);
        for (int i = 0; i < 3; ++i) {
            const Vec3d p = point(s, i), q = point(s, after(i));
            if (turn(p, q, t.point[0]) == -inside && turn(p, q, t.point[1]) == -inside &&
                turn(p, q, t.point[2]) == -inside)
                return true;
        }
        return false;
    }

    /// True if the triangles' angles at the shared corner overlap. Two angles below 180 degrees at one corner have a
    /// ray in common iff a leg of one lies in the other.
    CRUMPLE_HD bool corners_overlap() {
        const int i = first(sharing_.a), j = first(sharing_.b);
        const Vec3d apex = point(a_, i);
        Vec3d p = point(a_, after(i)), q = point(a_, before(i)), s = point(b_, after(j)), t = point(b_, before(j));
        if (turn(apex, p, q) < 0) swap_values(p, q);
        if (turn(apex, s, t) < 0) swap_values(s, t);
        const int ps = turn(apex, p, s), pt = turn(apex, p, t), qs = turn(apex, q, s), qt = turn(apex, q, t);
        return (ps >= 0 && qs <= 0) || (pt >= 0 && qt <= 0) || (ps <= 0 && pt >= 0) || (qs <= 0 && qt >= 0);
    }

    /// True if two triangles with a shared edge lie on the same side of it.
    CRUMPLE_HD bool folded() {
        const auto& [a0, a1, a2] = sharing_.a;
        const auto& [b0, b1, b2] = sharing_.b;
        const int i = first({!a0, !a1, !a2}), j = first({!b0, !b1, !b2});
        const Vec3d p = point(a_, after(i)), q = point(a_, before(i));
        return turn(p, q, point(a_, i)) == turn(p, q, point(b_, j));
    }

    const Triangle& a_;
    const Triangle& b_;
    const Sharing& sharing_;
    Signs& signs_;
    int axis_ = 0;  ///< axis dropped by the projection
};

CRUMPLE_HD inline bool degenerate(const Triangle& t, ExactSigns& signs) {
    const auto& [p, q, r] = t.point;
    return collinear(p, q, r, signs);
}

/// Decides pairs that the filters of decide() leave. `certain`: true if these filters have decided the sides of all
/// corners.
template <class Signs>
CRUMPLE_HD_COLD Verdict decide_by_cases(const Triangle& a, const Triangle& b, const Sharing& sharing, Sides side_a,
                                        Sides side_b, bool certain, bool proper, Signs& signs) {
    const auto verdict = [](bool collides) { return collides ? Verdict::collides : Verdict::apart; };
    if constexpr (Signs::exact) {
        if (!in_expansion_range(a) || !in_expansion_range(b)) return Verdict::undecided;
        if (!certain) {
            const bool a_degenerate = !side_b.prove_plane() && degenerate(a, signs);
            const bool b_degenerate = !side_a.prove_plane() && degenerate(b, signs);
            if (a_degenerate) return verdict(degenerate_collide(a, sharing.a, b, b_degenerate, proper, signs));
            if (b_degenerate) return verdict(degenerate_collide(b, sharing.b, a, false, proper, signs));
            side_a.complete(b, a, signs);
            side_b.complete(a, b, signs);
            if (side_a.separated(sharing.a) || side_b.separated(sharing.b)) return Verdict::apart;
        }
    }
    Cases<Signs> cases(a, b, sharing, signs);
    const auto collides = [&] {
        const bool coplanar = side_a.zero();
        if (proper) return !coplanar && cases.cross(side_a, side_b);
        if (coplanar) return cases.overlap_in_plane();
        return sharing.count == 0 ? cases.overlap_on_line(side_a, side_b) : cases.same_direction(side_a, side_b);
    };
    const Verdict found = verdict(collides());
    if constexpr (!Signs::exact) {
        if (signs.has_undecided()) return Verdict::undecided;
    }
    return found;
}

}  // namespace detail

/// Decides if the pair collides under `neighbours` and `intersections`, as far as `signs` can resolve it. Needs
/// round-to-nearest without flush-to-zero.
///
/// With FilteredSigns, for any finite coordinates, `undecided` means that exact arithmetic has to decide. With
/// ExactSigns, `undecided` means that coordinates are beyond the range of expansions (geometry/predicates.h), which
/// never happens for float32, and that rational arithmetic has to decide.
template <class Signs>
CRUMPLE_HD Verdict decide(const Triangle& a, const Triangle& b, Neighbours neighbours, IntersectionKind intersections,
                          Signs& signs) {
    const bool proper = intersections == IntersectionKind::proper;
    const Sharing sharing(a, b);
    if (neighbours == Neighbours::skip && sharing.count > 0) return Verdict::apart;
    if (sharing.count == 3) return proper ? Verdict::apart : Verdict::collides;
    // A triangle whose corners are all shared here is degenerate, and lies in the hull of the shared vertices.
    if (all(sharing.a) || all(sharing.b)) return Verdict::apart;

    const FilteredPlane plane_b(b.point);
    Sides side_a(plane_b, a, sharing.a);
    if (side_a.separated(sharing.a)) return Verdict::apart;
    const FilteredPlane plane_a(a.point);
    Sides side_b(plane_a, b, sharing.b);
    if (side_b.separated(sharing.b)) return Verdict::apart;

    const bool certain = side_a.certain() && side_b.certain();
    if (!certain) {
        const int axis = plane_a.dominant_axis();
        if (detail::edge_separates(a, b, sharing.a, sharing.b, axis) ||
            detail::edge_separates(b, a, sharing.b, sharing.a, axis))
            return Verdict::apart;
        if (sharing.count == 1 && detail::middle_separates(a, b, first(sharing.a), first(sharing.b)))
            return Verdict::apart;
    }
    if (Signs::exact || certain) return detail::decide_by_cases(a, b, sharing, side_a, side_b, certain, proper, signs);
    return Verdict::undecided;
}

}  // namespace crumple
