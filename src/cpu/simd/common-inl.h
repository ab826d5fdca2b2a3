// What the SIMD kernels share. Included once for each instruction set, between HWY_BEFORE_NAMESPACE and its end.

#if defined(CRUMPLE_CPU_SIMD_COMMON_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_COMMON_INL_H_
#undef CRUMPLE_CPU_SIMD_COMMON_INL_H_
#else
#define CRUMPLE_CPU_SIMD_COMMON_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "cpu/kernels.h"
#include "cpu/simd/compress_tables.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The mask as the low bits of an integer.
template <class D, class M>
HWY_INLINE std::uint64_t bits_of(D d, M mask) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
}

/// Writes the lanes that `mask` selects, packed, to `out`, and up to a full vector of rubbish behind them; returns
/// their number. AVX-512 compresses a register and stores it whole (compress to memory is slow on some processors). The
/// others look up a byte shuffle by the mask's bits, 128 bits at a time; Highway's own tables are copied to the stack
/// there by g++ 12, at each call.
template <class D, class V, class M>
HWY_INLINE std::size_t compress_to(D d, V v, M mask, hn::TFromD<D>* HWY_RESTRICT out) {
    using T = hn::TFromD<D>;
#if HWY_TARGET <= HWY_AVX3
    if constexpr (HWY_TARGET == HWY_AVX3_DL || sizeof(T) >= 4) {
        hn::StoreU(hn::Compress(v, mask), d, out);
        return hn::CountTrue(d, mask);
    } else {
        return hn::CompressStore(v, mask, d, out);
    }
#else
    constexpr std::size_t lanes = 16 / sizeof(T);
    const hn::FixedTag<T, lanes> block;
    const hn::Repartition<std::uint8_t, decltype(block)> bytes;
    const std::uint64_t bits = bits_of(d, mask);
    std::size_t count = 0;
    const auto store = [&](auto part, std::uint64_t part_bits) {
        const std::uint8_t* order;
        if constexpr (sizeof(T) == 2)
            order = compress_shuffles_16[part_bits & 255];
        else
            order = compress_shuffles_32[part_bits & 15];
        const auto packed = hn::TableLookupBytes(hn::BitCast(bytes, part), hn::Load(bytes, order));
        hn::StoreU(hn::BitCast(block, packed), block, out + count);
        count += static_cast<std::size_t>(__builtin_popcountll(part_bits & ((1u << lanes) - 1)));
    };
    if constexpr (hn::MaxLanes(D()) == lanes) {
        store(v, bits);
    } else {
        static_assert(hn::MaxLanes(D()) == 2 * lanes);
        store(hn::LowerHalf(block, v), bits);
        store(hn::UpperHalf(block, v), bits >> lanes);
    }
    return count;
#endif
}

/// Repeats a list's last pair for a vector's length behind its end, so that no lane reads what was not written.
HWY_INLINE void repeat_last(Array<std::uint32_t>& list, std::size_t lanes) {
    const std::size_t count = list.size();
    std::fill_n(list.data() + count, lanes, count ? list[count - 1] : 0u);
}

/// Blocks of 128 bits in a vector: rows of four that are handled at once.
constexpr int blocks = static_cast<int>(hn::MaxLanes(hn::ScalableTag<float>())) / 4;

/// Blocks 0 and 2, or 1 and 3, of two vectors of four.
#if HWY_TARGET <= HWY_AVX3
template <class V>
HWY_INLINE V even_blocks(V low, V high) {
    return V{_mm512_shuffle_f32x4(low.raw, high.raw, 0x88)};
}
template <class V>
HWY_INLINE V odd_blocks(V low, V high) {
    return V{_mm512_shuffle_f32x4(low.raw, high.raw, 0xdd)};
}
#endif

/// Four vectors of four blocks, transposed; its own inverse.
template <class D, class V>
HWY_INLINE void transpose_blocks(D d, V& a, V& b, V& c, V& e) {
    // Rows 0 and 2, 1 and 3 are joined first, so that the interleaving of blocks restores the order.
    const V even = hn::ConcatLowerLower(d, c, a), odd = hn::ConcatLowerLower(d, e, b);
    const V even2 = hn::ConcatUpperUpper(d, c, a), odd2 = hn::ConcatUpperUpper(d, e, b);
    a = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(odd), even);
    b = hn::OddEvenBlocks(odd, hn::SwapAdjacentBlocks(even));
    c = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(odd2), even2);
    e = hn::OddEvenBlocks(odd2, hn::SwapAdjacentBlocks(even2));
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
