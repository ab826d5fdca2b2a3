// Last filters of `narrow`: a separating plane or a separating edge line, for any pair that the earlier filters leave
// undecided; first in float32, then, for pairs still left, in float64 from the normalised vertices.
//
// A pair is apart if the corners of one triangle that the other does not share lie strictly on one side of the other's
// plane (float64 only; the plane filter has tried it in float32), or if, in the projection along the largest component
// of A's normal, an edge line of one separates them except for shared corners on that line. Pairs that intersect, and
// ties, stay undecided. Bounds: docs/narrow.md.

#if defined(CRUMPLE_INTERSECT_CPU_SEPARATION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_SEPARATION_INL_H_
#undef CRUMPLE_INTERSECT_CPU_SEPARATION_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_SEPARATION_INL_H_
#endif

#include "backends/cpu/intersections/records-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {

/// Corners of a vector of triangles.
template <class D>
struct Corners {
    hn::Vec<D> p[3][3];     ///< [corner][axis]
    hn::Mask<D> shared[3];  ///< true if the corner is also a corner of the other triangle
};

/// Masks of the lanes whose point lies certainly left, or certainly right, of a directed line in the projection.
template <class D>
struct LineSides {
    hn::Mask<D> left, right;
};

/// Returns the certain signs of the cross product of two differences of corners, each coordinate of which errs by at
/// most `delta` beyond its own rounding.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LineSides<D> side_of(D d, V au, V aw, V bu, V bw, hn::TFromD<D> delta, hn::TFromD<D> tiny) {
    using T = hn::TFromD<D>;
    const V m = hn::Mul(au, bw), n = hn::Mul(aw, bu), value = hn::Sub(m, n);
    V error =
        hn::MulAdd(hn::Set(d, turn_error<T>), hn::Add(hn::Abs(m), hn::Abs(n)), hn::Set(d, 2 * delta * delta + tiny));
    if constexpr (sizeof(T) == 4) {
        const V size = hn::Add(hn::Add(hn::Abs(au), hn::Abs(aw)), hn::Add(hn::Abs(bu), hn::Abs(bw)));
        error = hn::MulAdd(hn::Set(d, delta), size, error);
    }
    return {hn::Gt(value, error), hn::Lt(value, hn::Neg(error))};
}

// Returns the pairs that an edge line of t separates in the projection (u, w).
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> separated_by_edge(D d, const Corners<D>& t, const V tu[3], const V tw[3],
                                         const Corners<D>& other, const V ou[3], const V ow[3], hn::TFromD<D> delta,
                                         hn::TFromD<D> tiny) {
    auto result = hn::Lt(hn::Zero(d), hn::Zero(d));
    for (int k = 0; k < 3; ++k) {
        const int end = (k + 1) % 3, apex = (k + 2) % 3;
        const V eu = hn::Sub(tu[end], tu[k]), ew = hn::Sub(tw[end], tw[k]);
        const auto own = side_of(d, eu, ew, hn::Sub(tu[apex], tu[k]), hn::Sub(tw[apex], tw[k]), delta, tiny);
        auto left = own.right, right = own.left;  // where the other triangle must lie: opposite to the apex
        for (int j = 0; j < 3; ++j) {
            const auto side = side_of(d, eu, ew, hn::Sub(ou[j], tu[k]), hn::Sub(ow[j], tw[k]), delta, tiny);
            left = hn::And(left, hn::Or(other.shared[j], side.left));
            right = hn::And(right, hn::Or(other.shared[j], side.right));
        }
        result = hn::Or(result, hn::And(hn::Not(t.shared[apex]), hn::Or(left, right)));
    }
    return result;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> separated_by_edges(D d, const Corners<D>& a, const Corners<D>& b, const V normal[3],
                                          hn::TFromD<D> delta, hn::TFromD<D> tiny) {
    const V nx = hn::Abs(normal[0]), ny = hn::Abs(normal[1]), nz = hn::Abs(normal[2]);
    const auto along_x = hn::And(hn::Ge(nx, ny), hn::Ge(nx, nz)), along_y = hn::Ge(ny, nz);
    V au[3], aw[3], bu[3], bw[3];
    const auto project = [&](const Corners<D>& t, V u[3], V w[3]) {
        for (int c = 0; c < 3; ++c) {
            u[c] = hn::IfThenElse(along_x, t.p[c][1], hn::IfThenElse(along_y, t.p[c][2], t.p[c][0]));
            w[c] = hn::IfThenElse(along_x, t.p[c][2], hn::IfThenElse(along_y, t.p[c][0], t.p[c][1]));
        }
    };
    project(a, au, aw);
    project(b, bu, bw);
    return hn::Or(separated_by_edge(d, a, au, aw, b, bu, bw, delta, tiny),
                  separated_by_edge(d, b, bu, bw, a, au, aw, delta, tiny));
}

/// Sets shared[] of both triangles; returns the pairs in which each corner of one triangle is a corner of the other.
template <class D, class VI>
HWY_INLINE hn::Mask<D> compare_ids(D d, const VI id_a[3], const VI id_b[3], Corners<D>& a, Corners<D>& b) {
    const auto named_by = [&](VI id, const VI other[3]) {
        return hn::RebindMask(d, hn::Or(hn::Eq(id, other[0]), hn::Or(hn::Eq(id, other[1]), hn::Eq(id, other[2]))));
    };
    for (int c = 0; c < 3; ++c) {
        a.shared[c] = named_by(id_a[c], id_b);
        b.shared[c] = named_by(id_b[c], id_a);
    }
    return hn::Or(hn::And(a.shared[0], hn::And(a.shared[1], a.shared[2])),
                  hn::And(b.shared[0], hn::And(b.shared[1], b.shared[2])));
}

// Drops the pairs of out.undecided that the mask `apart(packed)` selects.
template <class D, class Apart>
HWY_INLINE void drop_undecided(D d, Verdicts& out, Apart apart) {
    constexpr std::size_t lanes = hn::MaxLanes(D());
    const std::size_t count = out.undecided.size();
    std::uint32_t* list = out.undecided.data();
    repeat_last(out.undecided, lanes);
    std::size_t left = 0;
    for (std::size_t k = 0; k < count; k += lanes) {
        const std::uint64_t open = ~bits_of(d, apart(list + k));
        for (std::size_t l = 0; l < lanes && k + l < count; ++l) {
            list[left] = list[k + l];
            left += open >> l & 1;
        }
    }
    out.undecided.resize(left);
}

// Drops pairs that an edge line separates in float32, in the projection. triangles_of(record_of) loads a vector of
// triangles, that of lane i from *record_of(i); each coordinate of a difference of two of their corners errs by at most
// `delta` beyond its own rounding.
template <class TrianglesOf>
HWY_INLINE void separating_test_with(const Record* record, const CandidateChunk& candidates, float delta,
                                     TrianglesOf triangles_of, Verdicts& out) {
    const hn::ScalableTag<float> d;
    using D = hn::ScalableTag<float>;
    using V = hn::Vec<D>;
    const Record* rows = record + candidates.rows;
    const Record* columns = record + candidates.columns;
    drop_undecided(d, out, [&](const std::uint32_t* packed) HWY_ATTR {
        const auto row = triangles_of([&](int lane) { return rows + (packed[lane] & 0xffff); });
        const auto column = triangles_of([&](int lane) { return columns + (packed[lane] >> 16); });
        Corners<D> a, b;
        for (int c = 0; c < 3; ++c) {
            const auto copy = [](const Point<V>& p, V(&to)[3]) { to[0] = p.x, to[1] = p.y, to[2] = p.z; };
            copy(row.corner[c], a.p[c]);
            copy(column.corner[c], b.p[c]);
        }
        const V normal[3] = {row.normal.x, row.normal.y, row.normal.z};
        const auto same = compare_ids(d, row.id, column.id, a, b);
        return hn::And(hn::Not(same), separated_by_edges(d, a, b, normal, delta, turn_slack));
    });
}

/// Drops pairs that an edge line separates in float32. Reads corners from the normalised rows if these are float32, and
/// so exact; otherwise from the records, whose corners were rounded when the leaf's origin was subtracted.
inline void separating_test_float(const Record* record, const CandidateChunk& candidates, const PointRows& points,
                                  float reach, Verdicts& out) {
    with_triangles(points, reach, [&](float difference_error, auto triangles_of) {
        separating_test_with(record, candidates, difference_error, triangles_of, out);
    });
}

using Doubles = hn::ScalableTag<double>;

/// Gathers coordinate `axis` of vertices, as float64, from either type of rows.
template <class VIds>
HWY_INLINE hn::Vec<Doubles> gather_axis(const PointRows& points, VIds vertex, int axis) {
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> ids;
    const VIds at = hn::Add(hn::ShiftLeft<2>(vertex), hn::Set(ids, axis));
    if (points.f) return hn::PromoteTo(d, hn::GatherIndex(hn::Rebind<float, Doubles>(), points.f, at));
    return hn::GatherIndex(d, points.d, hn::PromoteTo(hn::RebindToSigned<Doubles>(), at));
}

// Returns the pairs that the plane of t separates, and writes its normal n.
HWY_INLINE hn::Mask<Doubles> separated_by_plane(const Corners<Doubles>& t, const Corners<Doubles>& other,
                                                hn::Vec<Doubles> n[3], double slack) {
    const Doubles d;
    using V = hn::Vec<Doubles>;
    V size[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int y = (axis + 1) % 3, z = (axis + 2) % 3;
        const V m1 = hn::Mul(hn::Sub(t.p[1][y], t.p[0][y]), hn::Sub(t.p[2][z], t.p[0][z]));
        const V m2 = hn::Mul(hn::Sub(t.p[1][z], t.p[0][z]), hn::Sub(t.p[2][y], t.p[0][y]));
        n[axis] = hn::Sub(m1, m2);
        size[axis] = hn::Add(hn::Abs(m1), hn::Abs(m2));
    }
    const V relative = hn::Set(d, plane_error), tiny = hn::Set(d, slack);
    auto above = hn::Eq(tiny, tiny), below = above;
    for (int k = 0; k < 3; ++k) {
        V value = hn::Zero(d), error = hn::Zero(d);
        for (int axis = 0; axis < 3; ++axis) {
            const V w = hn::Sub(other.p[k][axis], t.p[0][axis]);
            value = hn::MulAdd(n[axis], w, value);
            error = hn::MulAdd(size[axis], hn::Abs(w), error);
        }
        error = hn::MulAdd(relative, error, tiny);
        above = hn::And(above, hn::Or(other.shared[k], hn::Gt(value, error)));
        below = hn::And(below, hn::Or(other.shared[k], hn::Lt(value, hn::Neg(error))));
    }
    return hn::Or(above, below);
}

/// Drops pairs that a plane or an edge line separates in float64.
inline void separating_test_double(const Record* record, const CandidateChunk& candidates, const PointRows& points,
                                   Verdicts& out) {
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> ids;
    const hn::Rebind<std::uint32_t, Doubles> bits;
    const hn::RebindToSigned<Doubles> wide;
    const double tiny = points.f ? float32_rows_slack : float64_rows_slack;
    const auto* rows = reinterpret_cast<const std::int32_t*>(record + candidates.rows) + 12;
    const auto* columns = reinterpret_cast<const std::int32_t*>(record + candidates.columns) + 12;
    drop_undecided(d, out, [&](const std::uint32_t* packed) {
        const auto both = hn::LoadU(bits, packed);
        const auto offset = [&](auto id) { return hn::BitCast(ids, hn::ShiftLeft<4>(id)); };  // 16 numbers per record
        const auto row = offset(hn::And(both, hn::Set(bits, 0xffffu))), column = offset(hn::ShiftRight<16>(both));
        Corners<Doubles> a, b;
        hn::Vec<decltype(wide)> id_a[3], id_b[3];
        for (int c = 0; c < 3; ++c) {
            const auto va = hn::GatherIndex(ids, rows + c, row);
            const auto vb = hn::GatherIndex(ids, columns + c, column);
            id_a[c] = hn::PromoteTo(wide, va);
            id_b[c] = hn::PromoteTo(wide, vb);
            for (int axis = 0; axis < 3; ++axis) {
                a.p[c][axis] = gather_axis(points, va, axis);
                b.p[c][axis] = gather_axis(points, vb, axis);
            }
        }
        const auto same = compare_ids(d, id_a, id_b, a, b);
        hn::Vec<Doubles> normal[3], unused[3];
        auto apart = separated_by_plane(a, b, normal, tiny);
        apart = hn::Or(apart, separated_by_plane(b, a, unused, tiny));
        apart = hn::Or(apart, separated_by_edges(d, a, b, normal, 0.0, tiny));
        return hn::And(hn::Not(same), apart);
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
