// One row of the sweep, that is, one triangle of a leaf (small set of triangles that one sweep searches): tests its box
// against those of other triangles, the columns, a vector at a time, and lists the columns whose boxes overlap the
// row's and whose pair with the row the leaf owns (stages/ownership.h): triangles with a common ownership bit are a
// pair of another leaf.
//
// Two intervals are apart iff one starts after the other's end, that is, iff a saturated difference is not zero. So
// four differences and the common ownership bits, ORed, are zero exactly for the columns to list.
//
// AVX-512 compares one axis straight to masks instead: comparisons and differences run on different units, which then
// share the work; an instruction packs the column numbers. Elsewhere, two vectors are packed to bytes, whose comparison
// with zero yields selection bits, and each eight of these bits look up the column numbers that they select.

#if defined(CRUMPLE_CPU_SIMD_SWEEP_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_SWEEP_ROW_INL_H_
#undef CRUMPLE_CPU_SIMD_SWEEP_ROW_INL_H_
#else
#define CRUMPLE_CPU_SIMD_SWEEP_ROW_INL_H_
#endif

#include "backends/cpu/simd/column_tables.h"
#include "backends/cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

using Columns = hn::ScalableTag<std::uint16_t>;
using ColumnVector = hn::Vec<Columns>;

/// Bounds of the boxes along the two axes across the sweep direction, one array for each bound, and the ownership bits
/// (`lower`).
struct BoxColumns {
    const std::uint16_t *HWY_RESTRICT low_y, *HWY_RESTRICT high_y, *HWY_RESTRICT low_z, *HWY_RESTRICT high_z,
        *HWY_RESTRICT lower;
};

/// Row's box and ownership bits, broadcast to all lanes.
struct RowLanes {
    ColumnVector low_y, high_y, low_z, high_z, lower;

    HWY_INLINE RowLanes(const BoxColumns& of, std::int64_t row)
        : low_y(hn::Set(Columns(), of.low_y[row])),
          high_y(hn::Set(Columns(), of.high_y[row])),
          low_z(hn::Set(Columns(), of.low_z[row])),
          high_z(hn::Set(Columns(), of.high_z[row])),
          lower(hn::Set(Columns(), of.lower[row])) {}

    /// Returns nonzero lanes for the columns from j on that are apart from the row along y.
    HWY_INLINE ColumnVector apart_in_y(const BoxColumns& of, std::int64_t j) const {
        const Columns d;
        return hn::Or(hn::SaturatedSub(hn::Load(d, of.low_y + j), high_y),
                      hn::SaturatedSub(low_y, hn::Load(d, of.high_y + j)));
    }
    /// Returns nonzero lanes for the columns that are apart from the row along z, or whose pair with it another leaf
    /// owns.
    HWY_INLINE ColumnVector apart_otherwise(const BoxColumns& of, std::int64_t j) const {
        const Columns d;
        const auto z = hn::Or(hn::SaturatedSub(hn::Load(d, of.low_z + j), high_z),
                              hn::SaturatedSub(low_z, hn::Load(d, of.high_z + j)));
        return hn::Or(z, hn::And(hn::Load(d, of.lower + j), lower));
    }
};

/// Lists the candidates among the columns [begin, end) of a row, as offsets from `origin`, from out[count] on; writes
/// up to 32 entries of garbage behind them. Returns the new count.
#if HWY_TARGET <= HWY_AVX3

HWY_INLINE std::int64_t sweep_row(const BoxColumns& of, std::int64_t row, std::int64_t begin, std::int64_t end,
                                  std::int64_t origin, std::uint16_t* HWY_RESTRICT out, std::int64_t count) {
    const Columns d;
    constexpr auto lanes = static_cast<std::int64_t>(hn::MaxLanes(Columns()));
    const RowLanes own(of, row);
    const auto candidates_from = [&](std::int64_t j) HWY_ATTR {
        const auto begun = _mm512_cmple_epu16_mask(hn::Load(d, of.low_y + j).raw, own.high_y.raw);
        const auto meet = _mm512_mask_cmple_epu16_mask(begun, own.low_y.raw, hn::Load(d, of.high_y + j).raw);
        const auto rest = own.apart_otherwise(of, j);
        return hn::Mask<Columns>{_mm512_mask_testn_epi16_mask(meet, rest.raw, rest.raw)};
    };
    const auto step = hn::Set(d, static_cast<std::uint16_t>(lanes));
    std::int64_t j = begin & -lanes;
    auto number = hn::Iota(d, static_cast<std::uint16_t>(j - origin));
    // Masks out lanes before `begin` in the first vector, and lanes from `end` on in the last.
    const auto lanes_from = [](std::int64_t n) { return hn::Mask<Columns>{static_cast<__mmask32>(~0u << n)}; };
    const auto lanes_to = [](std::int64_t n) { return hn::Mask<Columns>{static_cast<__mmask32>(~0u >> (31 - n))}; };
    auto candidates = hn::And(candidates_from(j), lanes_from(begin - j));
    const std::int64_t last_step = (end - 1) & -lanes;
    while (j != last_step) {
        count += static_cast<std::int64_t>(compress_to(d, number, candidates, out + count));
        number = hn::Add(number, step);
        j += lanes;
        candidates = candidates_from(j);
    }
    candidates = hn::And(candidates, lanes_to(end - 1 - j));
    return count + static_cast<std::int64_t>(compress_to(d, number, candidates, out + count));
}

#else

constexpr std::int64_t columns_a_step = 2 * hn::MaxLanes(Columns());
constexpr const auto& column_order = column_tables<columns_a_step>;

/// Returns one bit for each lane of two vectors, 1 if the lane is zero, in the order of `column_order`.
HWY_INLINE std::uint32_t zeros(ColumnVector first, ColumnVector second) {
    const hn::Repartition<std::int8_t, Columns> bytes;
    // Packs both in one vector, with AVX2 half by half; saturation keeps zero zero, and nonzero nonzero.
#if HWY_TARGET == HWY_AVX2
    const hn::VFromD<decltype(bytes)> packed{_mm256_packs_epi16(first.raw, second.raw)};
#elif HWY_TARGET == HWY_SSE4
    const hn::VFromD<decltype(bytes)> packed{_mm_packs_epi16(first.raw, second.raw)};
#else
    const hn::RebindToSigned<Columns> words;
    const hn::Half<decltype(bytes)> half;
    const auto packed = hn::Combine(bytes, hn::DemoteTo(half, hn::BitCast(words, second)),
                                    hn::DemoteTo(half, hn::BitCast(words, first)));
#endif
    return static_cast<std::uint32_t>(bits_of(bytes, hn::Eq(packed, hn::Zero(bytes))));
}

HWY_INLINE std::int64_t sweep_row(const BoxColumns& of, std::int64_t row, std::int64_t begin, std::int64_t end,
                                  std::int64_t origin, std::uint16_t* HWY_RESTRICT out, std::int64_t count) {
    const hn::FixedTag<std::uint16_t, 8> d;
    constexpr auto lanes = static_cast<std::int64_t>(hn::MaxLanes(Columns()));
    const RowLanes own(of, row);
    const auto candidates_from = [&](std::int64_t j) HWY_ATTR {
        return zeros(hn::Or(own.apart_in_y(of, j), own.apart_otherwise(of, j)),
                     hn::Or(own.apart_in_y(of, j + lanes), own.apart_otherwise(of, j + lanes)));
    };
    const auto step = hn::Set(d, static_cast<std::uint16_t>(columns_a_step));
    std::int64_t j = begin & -columns_a_step;
    auto start = hn::Set(d, static_cast<std::uint16_t>(j - origin));
    std::uint16_t* HWY_RESTRICT next = out + count;
    const auto list = [&](std::uint32_t candidates) HWY_ATTR {
        for (std::size_t eight = 0; eight < columns_a_step / 8; ++eight) {
            const std::uint32_t offset = column_order.offset(candidates, eight);
            hn::StoreU(hn::Add(start, hn::Load(d, column_order.numbers_at(eight, offset))), d, next);
            next += hwy::PopCount(offset);
        }
        start = hn::Add(start, step);
    };
    // Masks out columns before `begin` in the first step, and columns from `end` on in the last.
    std::uint32_t candidates = candidates_from(j) & ~column_order.first[begin - j];
    const std::int64_t last_step = (end - 1) & -columns_a_step;
    while (j != last_step) {
        list(candidates);
        j += columns_a_step;
        candidates = candidates_from(j);
    }
    list(candidates & column_order.first[end - j]);
    return next - out;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
