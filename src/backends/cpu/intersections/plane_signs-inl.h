// Signs that the plane filter writes and `classify` reads (PlaneSigns in verdicts.h): seven nibbles for each pair.
//
// AVX-512 compares to masks, so each of the seven signs has a stream of its own, to which masks are stored as they are,
// two pairs a byte; NEON uses streams, too. With AVX2 and SSE4, a mask is a vector, and each needs an instruction that
// moves it to an integer. So four masks are packed to one vector of bytes first. Each pair then has two words of four
// nibbles.

#if defined(CRUMPLE_INTERSECT_CPU_PLANE_SIGNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_PLANE_SIGNS_INL_H_
#undef CRUMPLE_INTERSECT_CPU_PLANE_SIGNS_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_PLANE_SIGNS_INL_H_
#endif

#include "backends/cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

using SignBytes = hn::ScalableTag<std::uint8_t>;
constexpr auto sign_lanes = static_cast<std::int64_t>(hn::MaxLanes(SignBytes()));

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4

/// Words of each pair: above_a, below_a, above_b, below_b, and same[0], same[1], same[2], from the lowest nibble on.
class SignWords {
   public:
    SignWords(PlaneSigns& signs, std::int64_t count)
        : sides_(signs.bytes.data()), same_(signs.bytes.data() + 2 * (count + padding)) {}

    template <class M>
    HWY_INLINE void put(std::int64_t pair, M above_a, M below_a, M above_b, M below_b, M same0, M same1, M same2) {
        pack(above_a, below_a, above_b, below_b, sides_ + 2 * pair);
        pack(same0, same1, same2, same2, same_ + 2 * pair);
    }

    /// Writes code(above_a, ..., same2) of the pairs from i on, one per 8-bit lane; returns their number.
    template <class Code>
    HWY_INLINE std::int64_t write_codes(std::int64_t i, Code code, std::uint8_t* HWY_RESTRICT out) const {
        const SignBytes d;
        using V = hn::Vec<SignBytes>;
        V sides_a, sides_b, same01, same2;
        hn::LoadInterleaved2(d, sides_ + 2 * i, sides_a, sides_b);
        hn::LoadInterleaved2(d, same_ + 2 * i, same01, same2);
        const V seven = hn::Set(d, 7);
        const auto low = [&](V bytes) HWY_ATTR { return hn::And(bytes, seven); };
        const auto high = [&](V bytes) HWY_ATTR { return hn::And(hn::ShiftRight<4>(bytes), seven); };
        hn::StoreU(
            code(low(sides_a), high(sides_a), low(sides_b), high(sides_b), low(same01), high(same01), low(same2)), d,
            out + i);
        return sign_lanes;
    }

   private:
    // Packs the lanes of four masks to bytes, block by block, and stores one bit of each byte.
    template <class M>
    static HWY_INLINE void pack(M m0, M m1, M m2, M m3, std::uint8_t* HWY_RESTRICT out) {
#if HWY_TARGET == HWY_AVX2
        const auto whole = [](M m) HWY_ATTR { return _mm256_castps_si256(m.raw); };
        const __m256i first = _mm256_packs_epi32(whole(m0), whole(m1)),
                      second = _mm256_packs_epi32(whole(m2), whole(m3));
        const auto bits = static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_packs_epi16(first, second)));
#else
        const auto whole = [](M m) HWY_ATTR { return _mm_castps_si128(m.raw); };
        const __m128i first = _mm_packs_epi32(whole(m0), whole(m1)), second = _mm_packs_epi32(whole(m2), whole(m3));
        const auto bits = static_cast<std::uint16_t>(_mm_movemask_epi8(_mm_packs_epi16(first, second)));
#endif
        std::memcpy(out, &bits, sizeof bits);
    }

    std::uint8_t *HWY_RESTRICT sides_, *HWY_RESTRICT same_;
};
using SignsOfPairs = SignWords;

#else

/// Seven streams: above_a, below_a, above_b, below_b, same[0], same[1], same[2].
class SignStreams {
   public:
    SignStreams(PlaneSigns& signs, std::int64_t count) {
        for (int k = 0; k < 7; ++k) stream_[k] = signs.bytes.data() + k * (count / 2 + padding);
    }

    template <class... M>
    HWY_INLINE void put(std::int64_t pair, M... masks) {
        int k = 0;
        (put_nibbles(masks, pair, stream_[k++]), ...);
    }

    template <class Code>
    HWY_INLINE std::int64_t write_codes(std::int64_t i, Code code, std::uint8_t* HWY_RESTRICT out) const {
        const SignBytes d;
        const auto seven = hn::Set(d, 7);
        // A byte holds the nibbles of two pairs; even and odd pairs go to separate vectors.
        const auto bytes = [&](int k) HWY_ATTR { return hn::LoadU(d, stream_[k] + i / 2); };
        const auto even = [&](int k) HWY_ATTR { return hn::And(bytes(k), seven); };
        const auto odd = [&](int k) HWY_ATTR { return hn::And(hn::ShiftRight<4>(bytes(k)), seven); };
        const auto codes = [&](const auto& half)
                               HWY_ATTR { return code(half(0), half(1), half(2), half(3), half(4), half(5), half(6)); };
        hn::StoreInterleaved2(codes(even), codes(odd), d, out + i);
        return 2 * sign_lanes;
    }

   private:
    // Stores the nibbles of `mask`, which belong to the candidates from `pair` on. If they fill whole bytes, the mask
    // is stored directly, so that no arithmetic on masks competes with that on vectors.
    template <class M>
    static HWY_INLINE void put_nibbles(M mask, std::int64_t pair, std::uint8_t* HWY_RESTRICT stream) {
        const hn::ScalableTag<float> d;
        std::uint8_t* bytes = stream + pair / 2;
        if constexpr (blocks > 1) {
            hn::StoreMaskBits(d, mask, bytes);
        } else {
            const auto bits = static_cast<std::uint8_t>(bits_of(d, mask));
            *bytes = static_cast<std::uint8_t>(pair % 2 ? *bytes | bits << 4 : bits);
        }
    }

    std::uint8_t* stream_[7];
};
using SignsOfPairs = SignStreams;

#endif

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
