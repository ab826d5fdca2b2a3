// Second filter of `narrow`: pairs without a shared vertex that neither triangle's plane separates, and for which it is
// certain on which side of the other's plane each of the six corners lies.
//
// Each triangle has one corner alone on its side of the other's plane, p1 and p2; orders (p1, q1, r1) and (p2, q2, r2)
// are chosen so that p1 lies above plane 2 and p2 above plane 1. Both triangles meet the line of the planes in an
// interval, and these overlap iff det(q1 - p1, p2 - p1, q2 - p1) <= 0 and det(r1 - p1, r2 - p1, p2 - p1) <= 0 (Guigue
// and Devillers 2003). Determinants in float32 carry a bound (docs/narrow.md); pairs within it stay undecided.
//
// An intersection is proper (IntersectionKind::proper) if an edge of one triangle strictly crosses the interior of the
// other. If the intervals overlap, it is proper unless they are equal: then edges only meet edges. This test does not
// detect equal intervals, so for proper intersections it leaves overlapping ones undecided.

#if defined(CRUMPLE_INTERSECT_CPU_EDGE_TEST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_EDGE_TEST_INL_H_
#undef CRUMPLE_INTERSECT_CPU_EDGE_TEST_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_EDGE_TEST_INL_H_
#endif

#include "backends/cpu/intersections/records-inl.h"
#include "backends/cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {

/// Tests the pairs of out.edges, and appends to out.hit and out.undecided all that are not apart. `reach`: the largest
/// |coordinate| of a corner in the leaf, the set of triangles that one sweep searches; `proper`: true if only proper
/// intersections count.
inline void edge_test(const Record* record, const CandidateChunk& candidates, float reach, bool proper, Verdicts& out) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(d)>;
    using VI = hn::Vec<decltype(di)>;
    constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<float>());
    const Record* rows = record + candidates.rows;
    const Record* columns = record + candidates.columns;

    const std::size_t count = out.edges.size();
    repeat_last(out.edges, lanes);
    repeat_last(out.edge_signs, lanes);
    const V relative = hn::Set(d, determinant_error), tiny = hn::Set(d, determinant_slack);
    const V delta = hn::Set(d, corner_error(reach)), delta3 = hn::Mul(delta, hn::Set(d, 3.0f));
    const V delta6 = hn::Mul(hn::Mul(delta, delta), hn::Set(d, 6.0f));
    const auto norm1 = [](const Point<V>& p) { return hn::Add(hn::Abs(p.x), hn::Add(hn::Abs(p.y), hn::Abs(p.z))); };
    // Computes the certain signs of det(a, b, c), as sets of lanes.
    const auto determinant = [&](const Point<V>& a, const Point<V>& b, const Point<V>& c, auto& positive,
                                 auto& negative) {
        const V m1 = hn::Mul(b.y, c.z), m2 = hn::Mul(b.z, c.y), m3 = hn::Mul(b.z, c.x), m4 = hn::Mul(b.x, c.z),
                m5 = hn::Mul(b.x, c.y), m6 = hn::Mul(b.y, c.x);
        const V value = hn::Add(hn::Mul(a.x, hn::Sub(m1, m2)),
                                hn::Add(hn::Mul(a.y, hn::Sub(m3, m4)), hn::Mul(a.z, hn::Sub(m5, m6))));
        const V permanent = hn::Add(hn::Mul(hn::Abs(a.x), hn::Add(hn::Abs(m1), hn::Abs(m2))),
                                    hn::Add(hn::Mul(hn::Abs(a.y), hn::Add(hn::Abs(m3), hn::Abs(m4))),
                                            hn::Mul(hn::Abs(a.z), hn::Add(hn::Abs(m5), hn::Abs(m6)))));
        const V A = norm1(a), B = norm1(b), C = norm1(c);
        const V products = hn::MulAdd(A, B, hn::MulAdd(B, C, hn::Mul(A, C)));
        const V input = hn::Add(products, hn::MulAdd(delta3, hn::Add(A, hn::Add(B, C)), delta6));
        const V error = hn::MulAdd(relative, permanent, hn::MulAdd(delta, input, tiny));
        positive = hn::Gt(value, error);
        negative = hn::Lt(value, hn::Neg(error));
    };

    std::size_t hits = out.hit.size(), undecided = out.undecided.size();
    for (std::size_t k = 0; k < count; k += lanes) {
        const auto packed = hn::LoadU(du, out.edges.data() + k);
        const auto order =
            hn::GatherIndex(di, edge_orders.data(), hn::BitCast(di, hn::LoadU(du, out.edge_signs.data() + k)));
        const std::uint32_t* pair = out.edges.data() + k;
        const auto a = load_triangles(d, [&](int lane) { return rows + (pair[lane] & 0xffff); });
        const auto b = load_triangles(d, [&](int lane) { return columns + (pair[lane] >> 16); });
        const VI three = hn::Set(di, 3);
        const Point<V> p1 = a.at(hn::And(order, three));
        const auto from_p1 = [&](const Point<V>& p) {
            return Point<V>{hn::Sub(p.x, p1.x), hn::Sub(p.y, p1.y), hn::Sub(p.z, p1.z)};
        };
        const Point<V> q1 = from_p1(a.at(hn::And(hn::ShiftRight<2>(order), three)));
        const Point<V> r1 = from_p1(a.at(hn::And(hn::ShiftRight<4>(order), three)));
        const Point<V> p2 = from_p1(b.at(hn::And(hn::ShiftRight<6>(order), three)));
        const Point<V> q2 = from_p1(b.at(hn::And(hn::ShiftRight<8>(order), three)));
        const Point<V> r2 = from_p1(b.at(hn::And(hn::ShiftRight<10>(order), three)));

        hn::Mask<decltype(d)> apart1, over1, apart2, over2;
        determinant(q1, p2, q2, apart1, over1);
        determinant(r1, r2, p2, apart2, over2);
        const auto valid = hn::FirstN(d, count - k);
        const auto certain = hn::And(over1, over2);
        const auto hit = hn::And(hn::And(valid, certain), hn::FirstN(d, proper ? 0 : lanes));
        const auto open = hn::And(hn::And(valid, hn::Not(hn::Or(apart1, apart2))), hn::Not(hit));
        hits += compress_to(du, packed, hn::RebindMask(du, hit), out.hit.data() + hits);
        undecided += compress_to(du, packed, hn::RebindMask(du, open), out.undecided.data() + undecided);
    }
    out.hit.resize(hits);
    out.undecided.resize(undecided);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
