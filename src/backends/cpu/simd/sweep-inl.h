// Stage `sweep`: tests rows, one by one, against their columns, in 16-bit lanes. A row is a member of a sorted leaf
// (small set of triangles); its columns are the rows that the sweep tests it with, whose intervals along the sweep
// direction may overlap the row's (stages/sort.h). Each row's candidates are padded to a multiple of
// CandidateChunk::group.

#if defined(CRUMPLE_CPU_SIMD_SWEEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_SWEEP_INL_H_
#undef CRUMPLE_CPU_SIMD_SWEEP_INL_H_
#else
#define CRUMPLE_CPU_SIMD_SWEEP_INL_H_
#endif

#include <algorithm>

#include "backends/cpu/simd/sweep_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

inline std::int64_t sweep(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                          std::uint16_t dummy, std::int64_t capacity, CandidateChunk& out) {
    const Columns d;
    constexpr auto lanes = static_cast<std::int64_t>(hn::MaxLanes(Columns()));
    const BoxColumns boxes{leaf.low_y.data(), leaf.high_y.data(), leaf.low_z.data(), leaf.high_z.data(),
                           leaf.lower.data()};
    const RowLink* HWY_RESTRICT links = leaf.link.data();
    const std::int32_t* HWY_RESTRICT begins = leaf.begin.empty() ? nullptr : leaf.begin.data();

    out.dummy = dummy;
    const std::int64_t columns = out.columns, first_row = out.rows, group = out.group;
    std::uint16_t* HWY_RESTRICT column = out.column.data();
    std::uint16_t* HWY_RESTRICT rows = out.row.data();
    std::int64_t count = out.count, pairs = out.pairs;
    for (; row < last && count < capacity; ++row) {
        const std::int64_t end = std::min<std::int64_t>(links[row].end, block_end);
        const std::int64_t begin = std::max<std::int64_t>(begins ? begins[row] : row + 1, columns);
        if (begin >= end) continue;
        const std::int64_t first = count;
        count = sweep_row(boxes, row, begin, end, columns, column, count);
        pairs += count - first;
        for (int k = 0; k < 4; ++k) column[count + k] = dummy;
        count = (count + group - 1) & -group;
        const auto this_row = hn::Set(d, static_cast<std::uint16_t>(row - first_row));
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
