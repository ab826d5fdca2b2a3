// SIMD versions (counterparts) of the functions in filters/features/separating_direction.h, where the computations are
// explained: they drop pairs of triangles that a direction separates, one pair per lane. Integer template arguments are
// the number of time samples: 1 for static scenes, 2 for motion.

#if defined(CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_
#undef CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_
#else
#define CRUMPLE_FEATURES_CPU_SEPARATE_INL_H_
#endif

#include "backends/cpu/features/vectors-inl.h"
#include "backends/cpu/simd/compress-inl.h"
#include "filters/features/separating_direction.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {

/// Vector of records, one per lane.
template <class V, int moments>
struct Records {
    Point<V> at[4 * moments];                              ///< as FeatureRecord::at
    hn::Vec<hn::RebindToSigned<hn::DFromV<V>>> vertex[3];  ///< vertices of the corners
};

/// Loads one coordinate of each lane's record at one time sample: of the three corners and of the normal.
template <auto coordinate, class D, class RecordOf, class V = hn::Vec<D>>
HWY_INLINE void load_column(D d, RecordOf record, int moment, V& p0, V& p1, V& p2, V& normal) {
    V row[4];
    for (int r = 0; r < 4; ++r)
        row[r] = gather_blocks(
            d, [&](int b) HWY_ATTR { return hn::Load(Four(), record(4 * b + r)->*coordinate + 4 * moment); });
    transpose_rows(d, row, p0, p1, p2, normal);
}

template <int moments>
HWY_INLINE V4 load_vertices(const FeatureRecord<moments>* record) {
    return hn::BitCast(Four(), hn::Load(hn::RebindToSigned<Four>(), record->vertex));
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
    const hn::RebindToSigned<D> di;
    V row[4], column[3], owned;
    for (int r = 0; r < 4; ++r)
        row[r] = gather_blocks(d, [&](int b) HWY_ATTR { return load_vertices(record(4 * b + r)); });
    transpose_rows(d, row, column[0], column[1], column[2], owned);
    for (int k = 0; k < 3; ++k) out.vertex[k] = hn::BitCast(di, column[k]);
}

/// Loads records like load_columns(), but one record for all lanes of a block: aligned groups of four candidates have
/// the same row.
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
    const auto v = hn::BitCast(hn::RebindToSigned<D>(),
                               gather_blocks(d, [&](int b) HWY_ATTR { return load_vertices(record(b)); }));
    out.vertex[0] = hn::Broadcast<0>(v), out.vertex[1] = hn::Broadcast<1>(v), out.vertex[2] = hn::Broadcast<2>(v);
}

/// Returns the lanes in which direction n separates a from b by more than `gap` at each time sample, on the same side.
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

/// Counterpart of CommonCorner for one pair per lane.
template <class M>
struct CommonCorners {
    M of_a[3], of_b[3];  ///< lanes whose only common corner is this one
    M one;               ///< lanes with exactly one common corner
    M any;               ///< lanes with a common corner
};

template <int moments, class V, class M = decltype(hn::Gt(V(), V()))>
HWY_INLINE CommonCorners<M> common_corners(const Records<V, moments>& a, const Records<V, moments>& b) {
    const hn::DFromV<V> d;
    M same[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) same[i][j] = hn::RebindMask(d, hn::Eq(a.vertex[i], b.vertex[j]));
    CommonCorners<M> out;
    for (int k = 0; k < 3; ++k) {
        out.of_a[k] = hn::Or(same[k][0], hn::Or(same[k][1], same[k][2]));
        out.of_b[k] = hn::Or(same[0][k], hn::Or(same[1][k], same[2][k]));
    }
    const auto several = [](const M(&of)[3])
                             HWY_ATTR { return hn::Or(hn::And(of[0], of[1]), hn::And(of[2], hn::Or(of[0], of[1]))); };
    out.any = hn::Or(out.of_a[0], hn::Or(out.of_a[1], out.of_a[2]));
    out.one = hn::AndNot(hn::Or(several(out.of_a), several(out.of_b)), out.any);
    for (int k = 0; k < 3; ++k) {
        out.of_a[k] = hn::And(out.of_a[k], out.one);
        out.of_b[k] = hn::And(out.of_b[k], out.one);
    }
    return out;
}

/// Returns the lanes in which the direction between the centroids separates a from b. If a and b have exactly one
/// common corner, it need only separate the other corners of both from the common one, to opposite sides. The gap is
/// scaled by the direction's length.
template <int moments, class V, class M>
HWY_INLINE M separates_centroids(const Records<V, moments>& a, const Records<V, moments>& b, V gap,
                                 const CommonCorners<M>& common) {
    Point<V> n = between_centroids(a.at, b.at);
    if constexpr (moments == 2) n = add(n, between_centroids(a.at + 4, b.at + 4));
    gap = hn::Mul(gap, length(n));
    // Computes the extent of all corners along n; if there is exactly one common corner, of the other two, one of which
    // is taken twice. Returns the place of the common corner along n.
    const auto extent = [&](const Point<V>* p, const M(&is_common)[3], V& low, V& high) HWY_ATTR {
        const V p0 = dot(n, p[0]), p1 = dot(n, p[1]), p2 = dot(n, p[2]);
        const V q0 = hn::IfThenElse(is_common[0], p1, p0), q1 = hn::IfThenElse(is_common[1], p2, p1),
                q2 = hn::IfThenElse(is_common[2], p0, p2);
        low = least(q0, q1, q2);
        high = greatest(q0, q1, q2);
        return hn::IfThenElse(is_common[0], p0, hn::IfThenElse(is_common[1], p1, p2));
    };
    const auto at = [&](int m, M& above, M& below) HWY_ATTR {
        V low_a, high_a, low_b, high_b;
        const V corner = extent(a.at + 4 * m, common.of_a, low_a, high_a);
        extent(b.at + 4 * m, common.of_b, low_b, high_b);
        const auto beyond = [&](V low, V high) HWY_ATTR {
            const V from = hn::IfThenElse(common.one, corner, high), to = hn::IfThenElse(common.one, corner, low);
            return hn::And(hn::Gt(hn::Sub(low, from), gap), hn::Gt(hn::Sub(to, high), gap));
        };
        above = beyond(low_b, high_a);
        below = beyond(low_a, high_b);
    };
    M above, below;
    at(0, above, below);
    if constexpr (moments == 2) {
        M above_end, below_end;
        at(1, above_end, below_end);
        above = hn::And(above, above_end);
        below = hn::And(below, below_end);
    }
    return hn::Or(above, below);
}

/// Counterpart of most_at_start() for one pair per lane.
template <int moments, class V>
HWY_INLINE V most_at_start(const Records<V, moments>& a, const Records<V, moments>& b) {
    V square[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Point<V> way = subtract(b.at[j], a.at[i]);
            square[i][j] = dot(way, way);
        }
    V most = hn::Zero(hn::DFromV<V>());
    for (int i = 0; i < 3; ++i) {
        most = hn::Max(most, hn::Max(least(square[i][0], square[i][1], square[i][2]),
                                     least(square[0][i], square[1][i], square[2][i])));
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, j1 = (j + 1) % 3;
            most = hn::Max(most, hn::Min(hn::Min(square[i][j], square[i][j1]), hn::Min(square[i1][j], square[i1][j1])));
        }
    }
    return hn::Sqrt(hn::Add(most, hn::Set(hn::DFromV<V>(), least_square)));
}

/// Counterpart of NeededGap::of() for one pair per lane.
template <int moments, class V>
HWY_INLINE V needed_gap(const Records<V, moments>& a, const Records<V, moments>& b, const NeededGap& gap) {
    const hn::DFromV<V> d;
    const V of_all = hn::Set(d, gap.gap);
    if (!(gap.share > 0)) return of_all;
    const V most = hn::MulAdd(most_at_start(a, b), hn::Set(d, 1.000002f), hn::Set(d, 2 * gap.error));
    return hn::Max(of_all, hn::MulAdd(hn::Set(d, gap.share), most, hn::Set(d, gap.error)));
}

template <int moments>
std::size_t separate(const FeatureRecord<moments>* record, const CandidateChunk& candidates, const NeededGap& gap,
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
    const auto dummy = hn::Set(du, candidates.dummy);
    std::size_t count = 0;
    for (std::int64_t pair = 0; pair < candidates.count; pair += lanes) {
        Records<V, moments> a, b;
        load_rows<moments>(
            d, [&](int block) { return rows + row[pair + 4 * block]; }, a);
        load_columns<moments>(
            d, [&](int lane) { return columns + column[pair + lane]; }, b);
        const auto columns_of = hn::PromoteTo(du, hn::LoadU(d16, column + pair));
        const auto rows_of = hn::PromoteTo(du, hn::LoadU(d16, row + pair));
        const auto common = common_corners(a, b);
        const V needed = needed_gap(a, b, gap);
        auto apart = hn::Or(hn::RebindMask(d, hn::Eq(columns_of, dummy)), separates_centroids(a, b, needed, common));
        // A normal cannot separate triangles with a common corner, so often nothing is left to test.
        if (!hn::AllTrue(d, hn::Or(apart, common.any))) {
            apart = hn::Or(apart, hn::Or(separates(a.at[3], a, b, needed), separates(b.at[3], a, b, needed)));
            if constexpr (moments == 2)
                apart = hn::Or(apart, hn::Or(separates(a.at[7], a, b, needed), separates(b.at[7], a, b, needed)));
        }
        const auto keep = hn::RebindMask(du, hn::Not(apart));
        count += compress_to(du, hn::Or(hn::ShiftLeft<16>(columns_of), rows_of), keep, left + count);
    }
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();

#endif
