// Packs the selected lanes of a vector: what the sweep does once for every 8 to 32 interval tests.
//
// compress_to(d, v, mask, out) writes the lanes that `mask` selects, packed, to `out`, and up to a full vector of
// rubbish behind them; it returns their number. Each instruction set has its own way.

#if defined(CRUMPLE_CPU_SIMD_COMPRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_COMPRESS_INL_H_
#undef CRUMPLE_CPU_SIMD_COMPRESS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_COMPRESS_INL_H_
#endif

#include "cpu/simd/common-inl.h"
#include "cpu/simd/compress_tables.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

#if HWY_TARGET <= HWY_AVX3

// A register is compressed and stored whole; compress to memory is slow on some processors.
template <class D, class V, class M>
HWY_INLINE std::size_t compress_to(D d, V v, M mask, hn::TFromD<D>* HWY_RESTRICT out) {
    if constexpr (HWY_TARGET == HWY_AVX3_DL || sizeof(hn::TFromD<D>) >= 4) {
        hn::StoreU(hn::Compress(v, mask), d, out);
        return hn::CountTrue(d, mask);
    } else {
        return hn::CompressStore(v, mask, d, out);
    }
}

#elif HWY_TARGET == HWY_AVX2

// Sixteen lanes of 16 bits, each half by a shuffle of its own. A mask of bytes has two bits a lane, so their number is
// a number of bytes, and every other one makes the index of a shuffle of 16 bytes. Addresses scale by 8: a 0 in bit 0,
// which both selections keep, doubles the index.
template <class V, class M>
HWY_INLINE std::size_t compress_16(V v, M mask, std::uint16_t* HWY_RESTRICT out) {
    const auto bits = static_cast<std::uint32_t>(_mm256_movemask_epi8(mask.raw));
    const std::uint64_t shifted = std::uint64_t{bits} << 1;
    const auto packed = [&](__m128i half, std::uint64_t selection) HWY_ATTR {
        const auto* order = compress_shuffles_16[0] + 8 * _pext_u64(shifted, selection);
        return _mm_shuffle_epi8(half, _mm_load_si128(reinterpret_cast<const __m128i*>(order)));
    };
    auto* bytes = reinterpret_cast<char*>(out);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(bytes), packed(_mm256_castsi256_si128(v.raw), 0x15555));
    bytes += __builtin_popcount(bits & 0xffff);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(bytes), packed(_mm256_extracti128_si256(v.raw, 1), 0x155540001));
    return static_cast<std::size_t>(__builtin_popcount(bits)) / 2;
}

template <class D, class V, class M>
HWY_INLINE std::size_t compress_to(D d, V v, M mask, hn::TFromD<D>* HWY_RESTRICT out) {
    if constexpr (sizeof(hn::TFromD<D>) == 2) {
        return compress_16(v, mask, out);
    } else {
        const hn::Rebind<std::uint8_t, D> bytes;
        const hn::RebindToUnsigned<D> du;
        const std::uint64_t bits = bits_of(d, mask);
        const auto order = hn::PromoteTo(du, hn::Load(bytes, compress_orders_32[bits]));
        hn::StoreU(hn::TableLookupLanes(v, hn::IndicesFromVec(d, order)), d, out);
        return static_cast<std::size_t>(__builtin_popcountll(bits));
    }
}

#else

// 128 bits by a byte shuffle. Highway's own tables are copied to the stack here by g++ 12, at each call.
template <class D, class V, class M>
HWY_INLINE std::size_t compress_to(D d, V v, M mask, hn::TFromD<D>* HWY_RESTRICT out) {
    const hn::Repartition<std::uint8_t, D> bytes;
    static_assert(hn::MaxLanes(bytes) == 16);
    const std::uint64_t bits = bits_of(d, mask);
    const std::uint8_t* order;
    if constexpr (sizeof(hn::TFromD<D>) == 2)
        order = compress_shuffles_16[bits];
    else
        order = compress_shuffles_32[bits];
    const auto packed = hn::TableLookupBytes(hn::BitCast(bytes, v), hn::Load(bytes, order));
    hn::StoreU(hn::BitCast(d, packed), d, out);
    return static_cast<std::size_t>(__builtin_popcountll(bits));
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
