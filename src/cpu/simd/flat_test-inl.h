// Third filter of `narrow`: neighbours that lie nearly in one plane, by far the most frequent pairs of a smooth mesh.
//
// Seen along the largest component of A's normal, an edge line through the shared vertices that has the rest of A
// strictly on one side and the rest of B strictly on the other separates them but for what they share: then they do
// not collide. With one shared vertex v, A = (v, p, q), B = (v, r, t), the lines through v and each of p, q, r, t may
// do; with two, the line through both. What this does not settle, odd neighbours ([a, a, b]) among it, is undecided.

#if defined(CRUMPLE_CPU_SIMD_FLAT_TEST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_FLAT_TEST_INL_H_
#undef CRUMPLE_CPU_SIMD_FLAT_TEST_INL_H_
#else
#define CRUMPLE_CPU_SIMD_FLAT_TEST_INL_H_
#endif

#include "cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

/// Appends to out.undecided. `reach`: the leaf's largest coordinate. Corners come from the normalised rows where these
/// are float32, and so exact; otherwise from the records.
inline void flat_test(const SortedLeaf& leaf, const Candidates& candidates, const PointRows& points, float reach,
                      Verdicts& out) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(d)>;
    using VI = hn::Vec<decltype(di)>;
    constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<float>());
    const auto* rows = reinterpret_cast<const float*>(leaf.record.data() + candidates.rows);
    const auto* columns = reinterpret_cast<const float*>(leaf.record.data() + candidates.columns);

    const std::size_t count = out.flat.size();
    repeat_last(out.flat, lanes);
    repeat_last(out.flat_shared, lanes);
    const VI zero = hn::Zero(di), one = hn::Set(di, 1), two = hn::Set(di, 2), three = hn::Set(di, 3),
             seven = hn::Set(di, 7);
    const auto next = [&](VI corner) { return hn::IfThenElse(hn::Eq(corner, two), zero, hn::Add(corner, one)); };
    const auto is_single = [&](VI e) { return hn::And(hn::Ne(e, zero), hn::Eq(hn::And(e, hn::Sub(e, one)), zero)); };
    const V relative = hn::Set(d, 6 * unit_roundoff);
    const bool exact = points.f != nullptr;
    const float difference_error = exact ? 0.0f : 2.1f * unit_roundoff * reach;
    const V delta = hn::Set(d, difference_error),
            tiny = hn::Set(d, 2 * difference_error * difference_error + turn_slack);

    std::size_t undecided = out.undecided.size();
    for (std::size_t k = 0; k < count; k += lanes) {
        const auto packed = hn::LoadU(du, out.flat.data() + k);
        const VI shared = hn::BitCast(di, hn::LoadU(du, out.flat_shared.data() + k));
        const VI shared_b = hn::And(shared, seven), shared_a = hn::ShiftRight<3>(shared);
        const VI apex_a = hn::Xor(shared_a, seven), apex_b = hn::Xor(shared_b, seven);
        const auto edge = hn::And(is_single(apex_a), is_single(apex_b));  // two shared vertices each
        const auto settled = hn::Or(edge, hn::And(is_single(shared_a), is_single(shared_b)));

        // v: the shared vertex; of a shared edge the one behind the apex, so that p is its other end and q the apex.
        // Corner 0 where there is no such thing: what those lanes say is not asked.
        const auto pivot = [&](VI e, VI apex) {
            const VI corner = hn::IfThenElse(edge, next(hn::ShiftRight<1>(apex)), hn::ShiftRight<1>(e));
            return hn::IfThenElseZero(settled, corner);
        };
        const VI v_a = pivot(shared_a, apex_a), p_a = next(v_a), q_a = next(p_a);
        const VI v_b = pivot(shared_b, apex_b), t_b = next(next(v_b)), r_b = hn::IfThenElse(edge, t_b, next(v_b));

        const VI row = hn::BitCast(di, hn::ShiftLeft<4>(hn::And(packed, hn::Set(du, 0xffffu))));
        const VI column = hn::BitCast(di, hn::ShiftLeft<4>(hn::ShiftRight<16>(packed)));
        const VI normal = hn::Add(row, three);
        const V nx = hn::Abs(hn::GatherIndex(d, rows, normal)), ny = hn::Abs(hn::GatherIndex(d, rows + 4, normal)),
                nz = hn::Abs(hn::GatherIndex(d, rows + 8, normal));
        const auto along_x = hn::RebindMask(di, hn::And(hn::Gt(nx, ny), hn::Gt(nx, nz)));
        const auto along_y = hn::RebindMask(di, hn::Gt(ny, nz));
        const VI u_axis = hn::IfThenElse(along_x, one, hn::IfThenElse(along_y, two, zero));
        const VI w_axis = next(u_axis);
        const VI u = exact ? u_axis : hn::ShiftLeft<2>(u_axis), w = exact ? w_axis : hn::ShiftLeft<2>(w_axis);

        struct Point {
            V u, w;
        };
        const auto at = [&](const float* base, VI record, VI corner) {
            VI index = hn::Add(record, corner);
            if (exact) {
                index = hn::ShiftLeft<2>(hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(base) + 12, index));
                base = points.f;
            }
            return Point{hn::GatherIndex(d, base, hn::Add(index, u)), hn::GatherIndex(d, base, hn::Add(index, w))};
        };
        const Point v = at(rows, row, v_a);
        const auto from_v = [&](Point p) { return Point{hn::Sub(p.u, v.u), hn::Sub(p.w, v.w)}; };
        const Point p = from_v(at(rows, row, p_a)), q = from_v(at(rows, row, q_a));
        const Point r = from_v(at(columns, column, r_b)), t = from_v(at(columns, column, t_b));

        struct Side {
            hn::Mask<decltype(d)> left, right;
        };
        const auto side = [&](const Point& a, const Point& b) {
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
            hn::And(hn::RebindMask(d, settled), hn::Or(hn::And(on_edge, by_p), hn::And(hn::Not(on_edge), by_any)));
        const auto open = hn::And(hn::FirstN(d, count - k), hn::Not(separated));
        undecided += compress_to(du, packed, hn::RebindMask(du, open), out.undecided.data() + undecided);
    }
    out.undecided.resize(undecided);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
