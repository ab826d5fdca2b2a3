// Packs the selected lanes of a vector.
//
// compress_to(d, v, mask, out) writes the lanes that `mask` selects, packed, to `out`, and garbage behind them, up to a
// full vector; it returns their number. Lanes have 32 bits, with AVX-512 also 16. Each instruction set has its own
// implementation.

#if defined(CRUMPLE_CPU_SIMD_COMPRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_COMPRESS_INL_H_
#undef CRUMPLE_CPU_SIMD_COMPRESS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_COMPRESS_INL_H_
#endif

#include "backends/cpu/simd/common-inl.h"
#include "backends/cpu/simd/compress_tables.h"

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

template <class D, class V, class M>
HWY_INLINE std::size_t compress_to(D d, V v, M mask, hn::TFromD<D>* HWY_RESTRICT out) {
    const hn::Rebind<std::uint8_t, D> bytes;
    const hn::RebindToUnsigned<D> du;
    const std::uint64_t bits = bits_of(d, mask);
    const auto order = hn::PromoteTo(du, hn::Load(bytes, compress_orders_32[bits]));
    hn::StoreU(hn::TableLookupLanes(v, hn::IndicesFromVec(d, order)), d, out);
    return hwy::PopCount(bits);
}

#else

// Packs 128 bits by a byte shuffle. g++ 12 would copy Highway's own tables to the stack at each call.
template <class D, class V, class M>
HWY_INLINE std::size_t compress_to(D d, V v, M mask, hn::TFromD<D>* HWY_RESTRICT out) {
    const hn::Repartition<std::uint8_t, D> bytes;
    static_assert(hn::MaxLanes(bytes) == 16);
    const std::uint64_t bits = bits_of(d, mask);
    const auto order = hn::Load(bytes, compress_shuffles_32[bits]);
    hn::StoreU(hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(bytes, v), order)), d, out);
    return hwy::PopCount(bits);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
