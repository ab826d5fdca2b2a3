// First filter of `narrow`: computes on which side of each triangle's plane the other's corners lie.
//
// A vector holds records of one, two or four candidates (128, 256, 512 bits), each in a block of four lanes. After a
// transpose of blocks, X, Y, Z hold x, y, z of the three corners and of the normal of every candidate. Then n_row . p -
// c_row for all corners is three multiply-adds, and the other plane takes three more with lanes broadcast. There is no
// branch and no gather. Each result is one nibble per pair, which `classify` reads.

#if defined(CRUMPLE_INTERSECT_CPU_PLANE_FILTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_PLANE_FILTER_INL_H_
#undef CRUMPLE_INTERSECT_CPU_PLANE_FILTER_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_PLANE_FILTER_INL_H_
#endif

#include "backends/cpu/intersections/plane_signs-inl.h"
#include "backends/cpu/intersections/records-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {

inline void plane_filter(const Record* record, const CandidateChunk& candidates, PlaneSigns& out) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    using V = hn::Vec<decltype(d)>;
    const Record* HWY_RESTRICT rows = record + candidates.rows;
    const Record* HWY_RESTRICT columns = record + candidates.columns;
    const std::uint16_t* HWY_RESTRICT row = candidates.row.data();
    const std::uint16_t* HWY_RESTRICT column = candidates.column.data();
    const std::int64_t count = candidates.count;
    SignsOfPairs signs(out, count);
    const V one = hn::Set(d, 1.0f), minus_one = hn::Set(d, -1.0f);
    for (std::int64_t pair = 0; pair < count; pair += blocks) {
        const Record& a = rows[row[pair]];
        V X, Y, Z, I;
        const auto of_block = [&](int b) { return columns + column[pair + b]; };
        load_records(d, of_block, X, Y, Z, I);
        const V of_a =
            hn::MulAdd(X, hn::Set(d, a.x[3]),
                       hn::MulAdd(Y, hn::Set(d, a.y[3]), hn::MulSub(Z, hn::Set(d, a.z[3]), hn::Set(d, a.c))));
        const V of_b =
            hn::MulAdd(hn::LoadDup128(d, a.x), hn::Broadcast<3>(X),
                       hn::MulAdd(hn::LoadDup128(d, a.y), hn::Broadcast<3>(Y),
                                  hn::MulSub(hn::LoadDup128(d, a.z), hn::Broadcast<3>(Z), hn::Broadcast<3>(I))));
        const auto ids = hn::BitCast(di, I);
        const auto same = [&](int k) HWY_ATTR { return hn::RebindMask(d, hn::Eq(ids, hn::Set(di, a.id[k]))); };
        signs.put(pair, hn::Gt(of_a, one), hn::Lt(of_a, minus_one), hn::Gt(of_b, one), hn::Lt(of_b, minus_one), same(0),
                  same(1), same(2));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
