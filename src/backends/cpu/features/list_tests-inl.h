// SIMD counterpart of filters/features/tests_of_pair.h: lists the tests (pairs of features) that pairs of triangles
// stand for, one pair of triangles per lane. Which of the fifteen possible tests a pair has is unpredictable, so a
// branch for each would often be mispredicted. Instead, for one possible test after the other, all pairs of a vector
// that have it are appended to a list at once.

#if defined(CRUMPLE_FEATURES_CPU_LIST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_FEATURES_CPU_LIST_INL_H_
#undef CRUMPLE_FEATURES_CPU_LIST_INL_H_
#else
#define CRUMPLE_FEATURES_CPU_LIST_INL_H_
#endif

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/simd/compress-inl.h"
#include "backends/cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

/// Representatives of the corners' vertices (equal for vertices that welding merges), and bits of the vertices and
/// edges that the triangle owns; one triangle per lane.
template <class V>
struct Names {
    V vertex[3], owned;
};

template <class D, class RecordOf, class V = hn::Vec<hn::RebindToSigned<D>>>
HWY_INLINE Names<V> load_names(D d, RecordOf record, const std::int32_t* names) {
    const hn::RebindToSigned<D> di;
    const hn::RebindToSigned<Four> four;
    hn::Vec<D> row[4], column[4];
    for (int r = 0; r < 4; ++r)
        row[r] =
            hn::BitCast(d, gather_blocks(di, [&](int b) HWY_ATTR { return hn::Load(four, record(4 * b + r).vertex); }));
    transpose_rows(d, row, column[0], column[1], column[2], column[3]);
    Names<V> out{{hn::BitCast(di, column[0]), hn::BitCast(di, column[1]), hn::BitCast(di, column[2])},
                 hn::BitCast(di, column[3])};
    if (names)
        for (V& v : out.vertex) v = hn::GatherIndex(di, names, v);
    return out;
}

template <int moments>
void list(const PairsLeft<moments>& pairs, const std::int32_t* names, TestList& vertex_face, TestList& edge_edge) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(di)>;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    static_assert(offsetof(FeatureRecord<moments>, vertex) % 16 == 0);
    const auto has = [&](V owned, int bit) HWY_ATTR { return hn::TestBit(owned, hn::Set(di, 1 << bit)); };
    for (std::size_t first = 0; first < pairs.count; first += lanes) {
        const auto pair = [&](int lane) { return std::min(first + static_cast<std::size_t>(lane), pairs.count - 1); };
        const auto a = load_names(
            d, [&](int lane) -> const auto& { return pairs.row(pair(lane)); }, names);
        const auto b = load_names(
            d, [&](int lane) -> const auto& { return pairs.column(pair(lane)); }, names);
        const auto here = hn::Lt(hn::Iota(di, 0), hn::Set(di, static_cast<std::int32_t>(pairs.count - first)));
        const auto place = hn::ShiftLeft<4>(hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(first))));
        const auto add = [&](TestList& listed, auto mask, int bit) HWY_ATTR {
            const auto test = hn::Or(place, hn::Set(du, static_cast<std::uint32_t>(bit)));
            listed.count += compress_to(du, test, hn::RebindMask(du, mask), listed.test + listed.count);
        };
        hn::Mask<decltype(di)> same[3][3];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) same[i][j] = hn::Eq(a.vertex[i], b.vertex[j]);
        for (int k = 0; k < 3; ++k) {
            const auto shared_a = hn::Or(same[k][0], hn::Or(same[k][1], same[k][2]));
            const auto shared_b = hn::Or(same[0][k], hn::Or(same[1][k], same[2][k]));
            add(vertex_face, hn::And(here, hn::AndNot(shared_a, has(a.owned, k))), k);
            add(vertex_face, hn::And(here, hn::AndNot(shared_b, has(b.owned, k))), 3 + k);
        }
        for (int i = 0; i < 3; ++i) {
            const auto owned_a = hn::And(here, has(a.owned, 3 + i));
            const int i1 = (i + 1) % 3;
            for (int j = 0; j < 3; ++j) {
                const int j1 = (j + 1) % 3;
                const auto shared = hn::Or(hn::Or(same[i][j], same[i][j1]), hn::Or(same[i1][j], same[i1][j1]));
                add(edge_edge, hn::And(owned_a, hn::AndNot(shared, has(b.owned, 3 + j))), 4 * i + j);
            }
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();

#endif
