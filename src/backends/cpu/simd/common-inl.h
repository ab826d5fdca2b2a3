// Helpers that the SIMD kernels share. Compiled once for each instruction set: the code between HWY_BEFORE_NAMESPACE
// and HWY_AFTER_NAMESPACE.

#if defined(CRUMPLE_CPU_SIMD_COMMON_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_COMMON_INL_H_
#undef CRUMPLE_CPU_SIMD_COMMON_INL_H_
#else
#define CRUMPLE_CPU_SIMD_COMMON_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "backends/cpu/stages/kernels.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns the mask as the low bits of an integer.
template <class D, class M>
HWY_INLINE std::uint64_t bits_of(D d, M mask) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
}

/// Repeats a list's last pair past its end for a vector's length, so that no lane reads unwritten memory.
HWY_INLINE void repeat_last(Array<std::uint32_t>& list, std::size_t lanes) {
    const std::size_t count = list.size();
    std::fill_n(list.data() + count, lanes, count ? list[count - 1] : 0u);
}

/// Number of blocks of 128 bits in a vector. A block has four lanes, such as a row x, y, z and padding.
constexpr int blocks = static_cast<int>(hn::MaxLanes(hn::ScalableTag<float>())) / 4;

/// Return blocks 0 and 2, or 1 and 3, of two vectors of four blocks each.
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

/// Transposes four vectors of four blocks; its own inverse.
template <class D, class V>
HWY_INLINE void transpose_blocks(D d, V& a, V& b, V& c, V& e) {
    // Halves of vectors 0 and 2, and of 1 and 3, are joined first, so that exchanging adjacent blocks completes the
    // transpose.
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
