// First filter of `narrow`: on which side of each triangle's plane do the other's corners lie?
//
// A vector holds one, two or four records (128, 256, 512 bits), one of a candidate's in each block of four lanes. After
// a transpose of blocks, X, Y, Z hold x, y, z of the three corners and of the normal of every candidate, so that
// n_row . p - c_row for all corners is three multiply-adds, and the other plane three more with lanes broadcast. There
// is no branch and no gather; what is found goes, as one nibble a pair, into words for 16 pairs.

#if defined(CRUMPLE_CPU_SIMD_PLANE_FILTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_PLANE_FILTER_INL_H_
#undef CRUMPLE_CPU_SIMD_PLANE_FILTER_INL_H_
#else
#define CRUMPLE_CPU_SIMD_PLANE_FILTER_INL_H_
#endif

#include "cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

/// Blocks of 128 bits in a vector: records that are loaded at once.
constexpr int blocks = static_cast<int>(hn::MaxLanes(hn::ScalableTag<float>())) / 4;

/// Record columns[j[b]] in block b, transposed: X = x0 x1 x2 nx | ..., I = id0 id1 id2 c | ...
template <class D, class V>
HWY_INLINE void load_records(D d, const Record* columns, const std::uint16_t* j, V& X, V& Y, V& Z, V& I) {
    const auto at = [&](int b) { return reinterpret_cast<const float*>(columns + j[b]); };
    if constexpr (blocks == 1) {
        X = hn::Load(d, at(0)), Y = hn::Load(d, at(0) + 4), Z = hn::Load(d, at(0) + 8), I = hn::Load(d, at(0) + 12);
    } else if constexpr (blocks == 2) {
        const V a = hn::Load(d, at(0)), a2 = hn::Load(d, at(0) + 8), b = hn::Load(d, at(1)),
                b2 = hn::Load(d, at(1) + 8);
        X = hn::ConcatLowerLower(d, b, a), Y = hn::ConcatUpperUpper(d, b, a);
        Z = hn::ConcatLowerLower(d, b2, a2), I = hn::ConcatUpperUpper(d, b2, a2);
    } else {
        // Rows 0 and 2, 1 and 3 are joined first, so that the interleaving of blocks restores the order.
        const V a = hn::Load(d, at(0)), b = hn::Load(d, at(1)), c = hn::Load(d, at(2)), e = hn::Load(d, at(3));
        const V even = hn::ConcatLowerLower(d, c, a), odd = hn::ConcatLowerLower(d, e, b);
        const V even2 = hn::ConcatUpperUpper(d, c, a), odd2 = hn::ConcatUpperUpper(d, e, b);
        X = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(odd), even),
        Y = hn::OddEvenBlocks(odd, hn::SwapAdjacentBlocks(even));
        Z = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(odd2), even2);
        I = hn::OddEvenBlocks(odd2, hn::SwapAdjacentBlocks(even2));
    }
}

// Three bits in each nibble: any of them, and all of them, in the lowest.
constexpr std::uint64_t low_bits = 0x1111111111111111u, three_bits = 0x7777777777777777u;
HWY_INLINE std::uint64_t any_of_three(std::uint64_t x) { return (x | x >> 1 | x >> 2) & low_bits; }
HWY_INLINE std::uint64_t all_of_three(std::uint64_t x) { return x & x >> 1 & x >> 2 & low_bits; }

/// Writes a PlaneSigns for each 16 pairs of which some survive; returns their number.
inline std::size_t plane_filter(const SortedLeaf& leaf, const Candidates& candidates, bool skip_neighbours,
                                PlaneSigns* HWY_RESTRICT out) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    using V = hn::Vec<decltype(d)>;
    const Record* HWY_RESTRICT rows = leaf.record.data() + candidates.rows;
    const Record* HWY_RESTRICT columns = leaf.record.data() + candidates.columns;
    const V one = hn::Set(d, 1.0f), minus_one = hn::Set(d, -1.0f);
    std::size_t survivors = 0;
    for (std::int64_t g = 0; g < candidates.groups; g += 4) {
        std::uint64_t above_a = 0, below_a = 0, above_b = 0, below_b = 0, same[3] = {0, 0, 0};
        for (int pair = 0; pair < 16; pair += blocks) {
            const Record& a = rows[candidates.row[g + pair / 4]];
            V X, Y, Z, I;
            load_records(d, columns, candidates.column.data() + 4 * g + pair, X, Y, Z, I);
            const V of_a =
                hn::MulAdd(X, hn::Set(d, a.x[3]),
                           hn::MulAdd(Y, hn::Set(d, a.y[3]), hn::MulSub(Z, hn::Set(d, a.z[3]), hn::Set(d, a.c))));
            const V of_b =
                hn::MulAdd(hn::LoadDup128(d, a.x), hn::Broadcast<3>(X),
                           hn::MulAdd(hn::LoadDup128(d, a.y), hn::Broadcast<3>(Y),
                                      hn::MulSub(hn::LoadDup128(d, a.z), hn::Broadcast<3>(Z), hn::Broadcast<3>(I))));
            const int shift = 4 * pair;
            above_a |= bits_of(d, hn::Gt(of_a, one)) << shift;
            below_a |= bits_of(d, hn::Lt(of_a, minus_one)) << shift;
            above_b |= bits_of(d, hn::Gt(of_b, one)) << shift;
            below_b |= bits_of(d, hn::Lt(of_b, minus_one)) << shift;
            const auto ids = hn::BitCast(di, I);
            for (int k = 0; k < 3; ++k) same[k] |= bits_of(di, hn::Eq(ids, hn::Set(di, a.id[k]))) << shift;
        }
        const std::uint64_t shared_b = (same[0] | same[1] | same[2]) & three_bits;
        const std::uint64_t shared_a = any_of_three(same[0] & three_bits) | any_of_three(same[1] & three_bits) << 1 |
                                       any_of_three(same[2] & three_bits) << 2;
        std::uint64_t apart = all_of_three(above_a | shared_b) | all_of_three(below_a | shared_b) |
                              all_of_three(above_b | shared_a) | all_of_three(below_b | shared_a);
        apart &= ~all_of_three(shared_b);  // duplicated faces are for the exact test
        if (skip_neighbours) apart |= any_of_three(shared_b);
        const std::uint64_t keep = ~apart & low_bits;
        out[survivors] = {keep, above_a, below_a, above_b, below_b, shared_b, shared_a, static_cast<std::uint64_t>(g)};
        survivors += keep != 0;
    }
    return survivors;
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
