// The decision goes from cheap to dear. First, what float64 filters can prove: the vertices that a triangle does not
// share lie strictly on one side of the other's plane, or of a line in projection, so that the two meet in what they
// share at most. That ends nearly all neighbours, flat meshes included. Then the exact signs of the vertices about the
// planes, by expansions where the filter left them open, and with them the cases:
//   - an interval test on the planes' common line, with closed comparisons;
//   - a shared vertex: both triangles meet the common line in a segment that begins there; only its direction matters;
//   - a shared edge: only a fold onto itself counts;
//   - one plane for both: the same questions in a projection.
// Degenerate triangles and coordinates beyond the range of expansions go to rational arithmetic.

#include "geometry/decide.h"

#include "geometry/arrangement.h"
#include "geometry/rational_intersection.h"

namespace crumple {
namespace {

/// An edge of `a`, seen along an axis, certainly has `a` on one closed side and the corners that `b` does not share
/// strictly on the other.
bool edge_separates(const Triangle& a, const Triangle& b, const std::array<bool, 3>& shared_a,
                    const std::array<bool, 3>& shared_b, int axis) {
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

/// Triangles that share their corners i and j certainly lie strictly on both sides of a plane through it. Any plane
/// will do; this one is normal to the difference of their bisectors, which also parts the two halves of a cross.
bool middle_separates(const Triangle& a, const Triangle& b, int i, int j) {
    const Vec3d apex = point(a, i);
    const Vec3d a1 = point(a, after(i)) - apex, a2 = point(a, before(i)) - apex;
    const Vec3d b1 = point(b, after(j)) - apex, b2 = point(b, before(j)) - apex;
    const auto unit = [](const Vec3d& d) { return (1 / std::sqrt(dot(d, d))) * d; };
    const Vec3d normal = (unit(a1) + unit(a2)) - (unit(b1) + unit(b2)), size = abs(normal);
    // The normal is exact by decree. Four roundings: a difference, a product, two sums.
    const auto side = [&](const Vec3d& d) {
        return detail::certain_sign(dot(normal, d), 5 * detail::epsilon * dot(size, abs(d)) + detail::slack);
    };
    return side(a1) == 1 && side(a2) == 1 && side(b1) == -1 && side(b2) == -1;
}

int first(const std::array<bool, 3>& corners) { return corners[0] ? 0 : corners[1] ? 1 : 2; }

/// The exact decision for triangles within the range of expansions; notes whether it needed them.
class Decision {
   public:
    Decision(const Triangle& a, const Triangle& b, const Sharing& sharing) : a_(a), b_(b), sharing_(sharing) {}

    bool needed_expansions() const { return needed_expansions_; }

    bool degenerate(const Triangle& t) {
        const auto& p = t.point;
        return turn(p[0], p[1], p[2], 0) == 0 && turn(p[0], p[1], p[2], 1) == 0 && turn(p[0], p[1], p[2], 2) == 0;
    }

    /// Whether two triangles in one plane meet outside of what they share.
    bool overlap_in_plane() {
        const auto& p = a_.point;
        axis_ = FilteredPlane(p).dominant_axis();
        while (turn(p[0], p[1], p[2], axis_) == 0) axis_ = after(axis_);
        if (sharing_.count == 0) return !outside_an_edge(a_, b_) && !outside_an_edge(b_, a_);
        return sharing_.count == 1 ? corners_overlap() : folded();
    }

    /// An edge of one strictly crosses the inside of the other.
    bool cross(const Sides& side_a, const Sides& side_b) { return crosses(a_, b_, side_a) || crosses(b_, a_, side_b); }

    /// Triangles without a common corner in different planes; signs not all on one side.
    bool overlap_on_line(const Sides& side_a, const Sides& side_b) {
        const CommonLine line(a_, b_, side_a, side_b);
        const auto& [a0, a1, a2] = line.a;
        const auto& [b0, b1, b2] = line.b;
        return orient(a0, a1, b0, b1) <= 0 && orient(a0, a2, b0, b2) >= 0;
    }

    /// Triangles that share a corner, in different planes: each lies across the other's plane, so it meets the common
    /// line in a segment from the corner; the side of its first other corner, seen counter-clockwise, tells which way.
    bool same_direction(const Sides& side_a, const Sides& side_b) const {
        return direction(side_a, first(sharing_.a)) != direction(side_b, first(sharing_.b));
    }

   private:
    int orient(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
        const int sign = orient3d_filtered(p, q, r, s);
        if (sign != undecided) return sign;
        needed_expansions_ = true;
        return orient3d_exact(p, q, r, s);
    }
    int turn(const Vec3d& p, const Vec3d& q, const Vec3d& r, int axis) {
        const int sign = orient2d_filtered(p, q, r, axis);
        if (sign != undecided) return sign;
        needed_expansions_ = true;
        return orient2d_exact(p, q, r, axis);
    }
    int turn(const Vec3d& p, const Vec3d& q, const Vec3d& r) { return turn(p, q, r, axis_); }

    static int direction(const Sides& side, int shared) {
        return side[after(shared)] != 0 ? side[after(shared)] : -side[before(shared)];
    }

    bool crosses(const Triangle& s, const Triangle& t, const Sides& side) {
        for (int i = 0; i < 3; ++i) {
            if (side[i] * side[after(i)] >= 0) continue;
            const Vec3d p = point(s, i), q = point(s, after(i));
            const int round = orient(p, q, t.point[0], t.point[1]);
            if (round != 0 && orient(p, q, t.point[1], t.point[2]) == round &&
                orient(p, q, t.point[2], t.point[0]) == round)
                return true;
        }
        return false;
    }

    /// All of t lies strictly outside one edge of s. Of disjoint convex polygons one has such an edge.
    bool outside_an_edge(const Triangle& s, const Triangle& t) {
        const int inside = turn(s.point[0], s.point[1], s.point[2]);
        for (int i = 0; i < 3; ++i) {
            const Vec3d p = point(s, i), q = point(s, after(i));
            if (turn(p, q, t.point[0]) == -inside && turn(p, q, t.point[1]) == -inside &&
                turn(p, q, t.point[2]) == -inside)
                return true;
        }
        return false;
    }

    /// Two angles below 180 degrees at one corner have a ray in common iff a leg of one lies in the other.
    bool corners_overlap() {
        const int i = first(sharing_.a), j = first(sharing_.b);
        const Vec3d apex = point(a_, i);
        Vec3d p = point(a_, after(i)), q = point(a_, before(i)), s = point(b_, after(j)), t = point(b_, before(j));
        if (turn(apex, p, q) < 0) std::swap(p, q);
        if (turn(apex, s, t) < 0) std::swap(s, t);
        const int ps = turn(apex, p, s), pt = turn(apex, p, t), qs = turn(apex, q, s), qt = turn(apex, q, t);
        return (ps >= 0 && qs <= 0) || (pt >= 0 && qt <= 0) || (ps <= 0 && pt >= 0) || (qs <= 0 && qt >= 0);
    }

    /// Two triangles on a common edge: both on the same side of it.
    bool folded() {
        const auto& [a0, a1, a2] = sharing_.a;
        const auto& [b0, b1, b2] = sharing_.b;
        const int i = first({!a0, !a1, !a2}), j = first({!b0, !b1, !b2});
        const Vec3d p = point(a_, after(i)), q = point(a_, before(i));
        return turn(p, q, point(a_, i)) == turn(p, q, point(b_, j));
    }

    const Triangle& a_;
    const Triangle& b_;
    const Sharing& sharing_;
    int axis_ = 0;  ///< dropped by the projection
    bool needed_expansions_ = false;
};

}  // namespace

bool collide(const Triangle& a, const Triangle& b, Neighbours neighbours, Intersections intersections,
             DecisionCounts& counts) {
    const Sharing sharing(a, b);
    if (neighbours == Neighbours::skip && sharing.count > 0) return false;
    if (sharing.count == 3) return intersections == Intersections::all;
    // One that has nothing of its own is degenerate and lies in the hull of what is shared.
    const std::array all_three{true, true, true};
    if (sharing.a == all_three || sharing.b == all_three) return false;

    const FilteredPlane plane_b(b.point);
    Sides side_a(plane_b, a, sharing.a);
    if (side_a.separated(sharing.a)) return false;
    const FilteredPlane plane_a(a.point);
    Sides side_b(plane_a, b, sharing.b);
    if (side_b.separated(sharing.b)) return false;

    const auto by_rationals = [&] {
        ++counts.exact;
        ++counts.rational;
        return collide(intersect_rationally(a, b), neighbours, intersections);
    };
    const bool certain = side_a.certain() && side_b.certain();
    if (!certain) {
        const int axis = plane_a.dominant_axis();
        if (edge_separates(a, b, sharing.a, sharing.b, axis) || edge_separates(b, a, sharing.b, sharing.a, axis))
            return false;
        if (sharing.count == 1 && middle_separates(a, b, first(sharing.a), first(sharing.b))) return false;
    }
    if (!in_expansion_range(a) || !in_expansion_range(b)) return by_rationals();

    // A certain sign that is not 0 proves that the plane's triangle is not degenerate.
    Decision decision(a, b, sharing);
    if (!certain) {
        if (decision.degenerate(a) || decision.degenerate(b)) return by_rationals();
        side_a.complete(b, a);
        side_b.complete(a, b);
        if (side_a.separated(sharing.a) || side_b.separated(sharing.b)) {
            ++counts.exact;
            return false;
        }
    }
    const bool result = [&] {
        const bool coplanar = side_a.zero();
        if (intersections == Intersections::proper) return !coplanar && decision.cross(side_a, side_b);
        if (coplanar) return decision.overlap_in_plane();
        return sharing.count == 0 ? decision.overlap_on_line(side_a, side_b) : decision.same_direction(side_a, side_b);
    }();
    if (!certain || decision.needed_expansions()) ++counts.exact;
    return result;
}

}  // namespace crumple
