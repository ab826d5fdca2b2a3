// Pairs of triangles that a direction separates, one pair a lane: lanes for questions/features/separation.h.

#if defined(CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_
#undef CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_
#else
#define CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_
#endif

#include "engine/cpu/simd/compress-inl.h"
#include "questions/features/cpu/vectors-inl.h"
#include "questions/features/record.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {

/// A vector of records, one a lane.
template <class V, int moments>
struct Records {
    Point<V> at[4 * moments];  ///< as FeatureRecord::at
};

/// One coordinate of the record of each lane, at one moment: of the three corners and of the normal.
template <auto coordinate, class D, class RecordOf, class V = hn::Vec<D>>
HWY_INLINE void load_column(D d, RecordOf record, int moment, V& p0, V& p1, V& p2, V& normal) {
    V row[4];
    for (int r = 0; r < 4; ++r)
        row[r] = gather_blocks(
            d, [&](int b) HWY_ATTR { return hn::Load(Four(), record(4 * b + r)->*coordinate + 4 * moment); });
    transpose_rows(d, row, p0, p1, p2, normal);
}

template <int moments, class D, class RecordOf, class V = hn::Vec<D>>
HWY_INLINE void load_columns(D d, RecordOf record, Records<V, moments>& out) {
    using Record = FeatureRecord<moments>;
    for (int m = 0; m < moments; ++m) {
        Point<V>* p = out.at + 4 * m;
        load_column<&Record::x>(d, record, m, p[0].x, p[1].x, p[2].x, p[3].x);
        load_column<&Record::y>(d, record, m, p[0].y, p[1].y, p[2].y, p[3].y);
        load_column<&Record::z>(d, record, m, p[0].z, p[1].z, p[2].z, p[3].z);
    }
}

/// The same where the lanes of a block have one record.
template <int moments, class D, class RecordOf, class V = hn::Vec<D>>
HWY_INLINE void load_rows(D d, RecordOf record, Records<V, moments>& out) {
    for (int m = 0; m < moments; ++m) {
        const V x = gather_blocks(d, [&](int b) HWY_ATTR { return hn::Load(Four(), record(b)->x + 4 * m); });
        const V y = gather_blocks(d, [&](int b) HWY_ATTR { return hn::Load(Four(), record(b)->y + 4 * m); });
        const V z = gather_blocks(d, [&](int b) HWY_ATTR { return hn::Load(Four(), record(b)->z + 4 * m); });
        Point<V>* p = out.at + 4 * m;
        p[0] = {hn::Broadcast<0>(x), hn::Broadcast<0>(y), hn::Broadcast<0>(z)};
        p[1] = {hn::Broadcast<1>(x), hn::Broadcast<1>(y), hn::Broadcast<1>(z)};
        p[2] = {hn::Broadcast<2>(x), hn::Broadcast<2>(y), hn::Broadcast<2>(z)};
        p[3] = {hn::Broadcast<3>(x), hn::Broadcast<3>(y), hn::Broadcast<3>(z)};
    }
}

/// Where direction n separates a from b by more than `gap`, at each moment and the same way round.
template <int moments, class V>
HWY_INLINE auto separates(const Point<V>& n, const Records<V, moments>& a, const Records<V, moments>& b, V gap) {
    const auto at = [&](int m, auto& above, auto& below) HWY_ATTR {
        V low_a, high_a, low_b, high_b;
        extent(n, a.at + 4 * m, low_a, high_a);
        extent(n, b.at + 4 * m, low_b, high_b);
        above = hn::Gt(hn::Sub(low_b, high_a), gap);
        below = hn::Gt(hn::Sub(low_a, high_b), gap);
    };
    decltype(hn::Gt(gap, gap)) above, below;
    at(0, above, below);
    if constexpr (moments == 2) {
        auto above_end = above, below_end = below;
        at(1, above_end, below_end);
        above = hn::And(above, above_end);
        below = hn::And(below, below_end);
    }
    return hn::Or(above, below);
}

/// The same of what is between the centroids, in whose length the gap is measured.
template <int moments, class V>
HWY_INLINE auto separates_centroids(const Records<V, moments>& a, const Records<V, moments>& b, V gap) {
    Point<V> n = between_centroids(a.at, b.at);
    if constexpr (moments == 2) n = add(n, between_centroids(a.at + 4, b.at + 4));
    return separates(n, a, b, hn::Mul(gap, length(n)));
}

template <int moments>
std::size_t separate(const FeatureRecord<moments>* record, const Candidates& candidates, float gap,
                     std::uint32_t* left) {
    const hn::ScalableTag<float> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(d)>;
    const hn::Rebind<std::uint16_t, decltype(d)> d16;
    constexpr auto lanes = static_cast<std::int64_t>(hn::MaxLanes(d));
    const FeatureRecord<moments>* rows = record + candidates.rows;
    const FeatureRecord<moments>* columns = record + candidates.columns;
    const std::uint16_t* row = candidates.row.data();
    const std::uint16_t* column = candidates.column.data();
    const V needed = hn::Set(d, gap);
    const auto dummy = hn::Set(du, candidates.dummy);
    std::size_t count = 0;
    for (std::int64_t pair = 0; pair < candidates.count; pair += lanes) {
        Records<V, moments> a, b;
        load_rows<moments>(
            d, [&](int block) { return rows + row[pair + 4 * block]; }, a);
        load_columns<moments>(
            d, [&](int lane) { return columns + column[pair + lane]; }, b);
        auto apart = hn::Or(separates(a.at[3], a, b, needed), separates(b.at[3], a, b, needed));
        if constexpr (moments == 2)
            apart = hn::Or(apart, hn::Or(separates(a.at[7], a, b, needed), separates(b.at[7], a, b, needed)));
        apart = hn::Or(apart, separates_centroids(a, b, needed));
        const auto columns_of = hn::PromoteTo(du, hn::LoadU(d16, column + pair));
        const auto rows_of = hn::PromoteTo(du, hn::LoadU(d16, row + pair));
        const auto keep = hn::AndNot(hn::RebindMask(du, apart), hn::Ne(columns_of, dummy));
        count += compress_to(du, hn::Or(hn::ShiftLeft<16>(columns_of), rows_of), keep, left + count);
    }
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();

#endif
