// Stage `sweep`: a row's box against a vector of columns, in 16-bit lanes.
//
// Two intervals are apart iff one starts after the other's end, that is iff a saturated difference is not zero. So four
// differences and the common ownership bits, ORed, are zero exactly for candidates that are ours. AVX-512 compares one
// axis straight to masks instead: comparisons and differences go to different units there, and each has half of them.

#if defined(CRUMPLE_CPU_SIMD_SWEEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_SWEEP_INL_H_
#undef CRUMPLE_CPU_SIMD_SWEEP_INL_H_
#else
#define CRUMPLE_CPU_SIMD_SWEEP_INL_H_
#endif

#include <algorithm>

#include "cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

inline std::int64_t sweep(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                          std::uint16_t dummy, std::int64_t capacity, Candidates& out) {
    const hn::ScalableTag<std::uint16_t> d;
    using V = hn::Vec<decltype(d)>;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    const std::uint16_t* HWY_RESTRICT low_y = leaf.low_y.data();
    const std::uint16_t* HWY_RESTRICT high_y = leaf.high_y.data();
    const std::uint16_t* HWY_RESTRICT low_z = leaf.low_z.data();
    const std::uint16_t* HWY_RESTRICT high_z = leaf.high_z.data();
    const std::uint16_t* HWY_RESTRICT lower = leaf.lower.data();
    const RowLink* HWY_RESTRICT links = leaf.link.data();
    const std::int32_t* HWY_RESTRICT begins = leaf.begin.empty() ? nullptr : leaf.begin.data();
    const V iota = hn::Iota(d, 0), step = hn::Set(d, static_cast<std::uint16_t>(lanes)), zero = hn::Zero(d);

    out.dummy = dummy;
    const std::int64_t columns = out.columns, first_row = out.rows;
    std::uint16_t* HWY_RESTRICT column = out.column.data();
    std::uint16_t* HWY_RESTRICT rows = out.row.data();
    std::int64_t count = out.count, pairs = out.pairs;
    for (; row < last && count < capacity; ++row) {
        const std::int64_t end = std::min<std::int64_t>(links[row].end, block_end);
        const std::int64_t begin = std::max<std::int64_t>(begins ? begins[row] : row + 1, columns);
        if (begin >= end) continue;
        const V row_low_y = hn::Set(d, low_y[row]), row_high_y = hn::Set(d, high_y[row]);
        const V row_low_z = hn::Set(d, low_z[row]), row_high_z = hn::Set(d, high_z[row]);
        const V row_lower = hn::Set(d, lower[row]);
        const auto free_of = [&](std::int64_t j) HWY_ATTR {
            const V start_y = hn::Load(d, low_y + j), end_y = hn::Load(d, high_y + j);
            const V z = hn::Or(hn::SaturatedSub(hn::Load(d, low_z + j), row_high_z),
                               hn::SaturatedSub(row_low_z, hn::Load(d, high_z + j)));
            const V rest = hn::Or(z, hn::And(hn::Load(d, lower + j), row_lower));
#if HWY_TARGET <= HWY_AVX3
            const auto free_y = _mm512_mask_cmple_epu16_mask(_mm512_cmple_epu16_mask(start_y.raw, row_high_y.raw),
                                                             row_low_y.raw, end_y.raw);
            return hn::Mask<decltype(d)>{_mm512_mask_testn_epi16_mask(free_y, rest.raw, rest.raw)};
#else
            const V y = hn::Or(hn::SaturatedSub(start_y, row_high_y), hn::SaturatedSub(row_low_y, end_y));
            return hn::Eq(hn::Or(y, rest), zero);
#endif
        };
        const std::int64_t first = count;
        std::int64_t j = begin & ~(lanes - 1);
        V index = hn::Add(iota, hn::Set(d, static_cast<std::uint16_t>(j - columns)));
        // Lanes before `begin` are out in the first vector, lanes from `end` on in the last.
        auto candidates = hn::And(free_of(j), hn::Not(hn::FirstN(d, static_cast<std::size_t>(begin - j))));
        for (; j + lanes < end; j += lanes) {
            count += static_cast<std::int64_t>(compress_to(d, index, candidates, column + count));
            index = hn::Add(index, step);
            candidates = free_of(j + lanes);
        }
        candidates = hn::And(candidates, hn::FirstN(d, static_cast<std::size_t>(end - j)));
        count += static_cast<std::int64_t>(compress_to(d, index, candidates, column + count));

        pairs += count - first;
        for (int k = 0; k < 4; ++k) column[count + k] = dummy;
        count = (count + 3) & ~std::int64_t{3};
        const V this_row = hn::Set(d, static_cast<std::uint16_t>(row - first_row));
        for (std::int64_t i = first; i < count; i += lanes) hn::StoreU(this_row, d, rows + i);
    }
    for (; count % 16; ++count) {
        rows[count] = 0;
        column[count] = dummy;
    }
    out.count = count;
    out.pairs = pairs;
    return row;
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
