// Third filter of `narrow`: adjacent triangles that are nearly coplanar, by far the most frequent pairs of a smooth
// mesh.
//
// In the projection along the largest component of A's normal, take an edge line through the shared vertices. If it has
// the rest of A strictly on one side and the rest of B strictly on the other, the triangles have only their shared
// vertices or edge in common, and do not collide. With one shared vertex v, A = (v, p, q), B = (v, r, t), the lines
// through v and each of p, q, r, t are tried; with two, the line through both. All other pairs stay undecided, among
// them pairs with a triangle that contains a vertex twice.

#if defined(CRUMPLE_INTERSECT_CPU_FLAT_TEST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_FLAT_TEST_INL_H_
#undef CRUMPLE_INTERSECT_CPU_FLAT_TEST_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_FLAT_TEST_INL_H_
#endif

#include "backends/cpu/intersections/records-inl.h"
#include "backends/cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {

/// Tests the pairs of out.flat, and appends to out.undecided all that no line separates. triangles_of(record) loads the
/// triangles of *record(lane); each coordinate of a difference of two of their corners errs by at most
/// `difference_error` beyond its own rounding.
template <class TrianglesOf>
HWY_INLINE void flat_test_with(const Record* record, const CandidateChunk& candidates, float difference_error,
                               TrianglesOf triangles_of, Verdicts& out) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(d)>;
    using VI = hn::Vec<decltype(di)>;
    constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<float>());
    const Record* rows = record + candidates.rows;
    const Record* columns = record + candidates.columns;

    const std::size_t count = out.flat.size();
    repeat_last(out.flat, lanes);
    repeat_last(out.flat_shared, lanes);
    const VI zero = hn::Zero(di), one = hn::Set(di, 1), two = hn::Set(di, 2), seven = hn::Set(di, 7);
    const auto next = [&](VI corner) { return hn::IfThenElse(hn::Eq(corner, two), zero, hn::Add(corner, one)); };
    const auto is_single = [&](VI e) { return hn::And(hn::Ne(e, zero), hn::Eq(hn::And(e, hn::Sub(e, one)), zero)); };
    const V relative = hn::Set(d, turn_error<float>);
    const V delta = hn::Set(d, difference_error),
            tiny = hn::Set(d, 2 * difference_error * difference_error + turn_slack);

    std::size_t undecided = out.undecided.size();
    for (std::size_t k = 0; k < count; k += lanes) {
        const auto packed = hn::LoadU(du, out.flat.data() + k);
        const VI shared = hn::BitCast(di, hn::LoadU(du, out.flat_shared.data() + k));
        const VI shared_b = hn::And(shared, seven), shared_a = hn::ShiftRight<3>(shared);
        const VI apex_a = hn::Xor(shared_a, seven), apex_b = hn::Xor(shared_b, seven);
        const auto edge = hn::And(is_single(apex_a), is_single(apex_b));  // two shared vertices in each triangle
        const auto is_decided = hn::Or(edge, hn::And(is_single(shared_a), is_single(shared_b)));

        // v: the shared vertex. If an edge is shared, v is the end that follows the apex, so that p is the other end of
        // the edge, and q the apex. Lanes with neither one nor two shared vertices get corner 0; their results are
        // ignored.
        const auto pivot = [&](VI e, VI apex) {
            const VI corner = hn::IfThenElse(edge, next(hn::ShiftRight<1>(apex)), hn::ShiftRight<1>(e));
            return hn::IfThenElseZero(is_decided, corner);
        };
        const VI v_a = pivot(shared_a, apex_a), p_a = next(v_a), q_a = next(p_a);
        const VI v_b = pivot(shared_b, apex_b), t_b = next(next(v_b)), r_b = hn::IfThenElse(edge, t_b, next(v_b));

        const std::uint32_t* pair = out.flat.data() + k;
        const auto a = triangles_of([&](int lane) { return rows + (pair[lane] & 0xffff); });
        const auto b = triangles_of([&](int lane) { return columns + (pair[lane] >> 16); });
        const V nx = hn::Abs(a.normal.x), ny = hn::Abs(a.normal.y), nz = hn::Abs(a.normal.z);
        const auto along_x = hn::And(hn::Gt(nx, ny), hn::Gt(nx, nz)), along_y = hn::Gt(ny, nz);
        struct Seen {
            V u, w;
        };
        const auto seen = [&](const Point<V>& p) {
            return Seen{hn::IfThenElse(along_x, p.y, hn::IfThenElse(along_y, p.z, p.x)),
                        hn::IfThenElse(along_x, p.z, hn::IfThenElse(along_y, p.x, p.y))};
        };
        const Seen v = seen(a.at(v_a));
        const auto from_v = [&](const Point<V>& corner) {
            const Seen s = seen(corner);
            return Seen{hn::Sub(s.u, v.u), hn::Sub(s.w, v.w)};
        };
        const Seen p = from_v(a.at(p_a)), q = from_v(a.at(q_a)), r = from_v(b.at(r_b)), t = from_v(b.at(t_b));

        struct Side {
            hn::Mask<decltype(d)> left, right;
        };
        const auto side = [&](const Seen& a, const Seen& b) {
            const V m = hn::Mul(a.u, b.w), n = hn::Mul(a.w, b.u), value = hn::Sub(m, n);
            const V size = hn::Add(hn::Add(hn::Abs(a.u), hn::Abs(a.w)), hn::Add(hn::Abs(b.u), hn::Abs(b.w)));
            const V error = hn::MulAdd(relative, hn::Add(hn::Abs(m), hn::Abs(n)), hn::MulAdd(delta, size, tiny));
            return Side{hn::Gt(value, error), hn::Lt(value, hn::Neg(error))};
        };
        const Side pq = side(p, q), rt = side(r, t), pr = side(p, r), pt = side(p, t), qr = side(q, r), qt = side(q, t);
        const auto all = [](auto a, auto b, auto c) { return hn::And(a, hn::And(b, c)); };
        const auto by_p = hn::Or(all(pq.left, pr.right, pt.right), all(pq.right, pr.left, pt.left));
        const auto by_q = hn::Or(all(pq.left, qr.left, qt.left), all(pq.right, qr.right, qt.right));
        const auto by_r = hn::Or(all(rt.left, pr.left, qr.left), all(rt.right, pr.right, qr.right));
        const auto by_t = hn::Or(all(rt.left, pt.right, qt.right), all(rt.right, pt.left, qt.left));
        const auto by_any = hn::Or(hn::Or(by_p, by_q), hn::Or(by_r, by_t));
        const auto on_edge = hn::RebindMask(d, edge);
        const auto separated =
            hn::And(hn::RebindMask(d, is_decided), hn::Or(hn::And(on_edge, by_p), hn::And(hn::Not(on_edge), by_any)));
        const auto open = hn::And(hn::FirstN(d, count - k), hn::Not(separated));
        undecided += compress_to(du, packed, hn::RebindMask(du, open), out.undecided.data() + undecided);
    }
    out.undecided.resize(undecided);
}

/// Runs the flat test. `reach`: the largest |coordinate| of a corner in the leaf, the set of triangles that one sweep
/// searches.
inline void flat_test(const Record* record, const CandidateChunk& candidates, const PointRows& points, float reach,
                      Verdicts& out) {
    with_triangles(points, reach, [&](float difference_error, auto triangles_of) {
        flat_test_with(record, candidates, difference_error, triangles_of, out);
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
