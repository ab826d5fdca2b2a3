// End of `narrow`: converts packed pairs of rows and columns to pairs of triangles, lower id first.

#if defined(CRUMPLE_INTERSECT_CPU_PAIRS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_PAIRS_INL_H_
#undef CRUMPLE_INTERSECT_CPU_PAIRS_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_PAIRS_INL_H_
#endif

#include "backends/cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

inline void triangles_of_pairs(const std::uint32_t* HWY_RESTRICT packed, std::size_t count, const RowLink* rows,
                               const RowLink* columns, Pair* HWY_RESTRICT out) {
    const hn::ScalableTag<std::int32_t> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const std::size_t lanes = hn::Lanes(d);
    static_assert(sizeof(RowLink) == 8 && offsetof(RowLink, triangle) == 4 && sizeof(Pair) == 8);
    const auto triangle_of = [&](const RowLink* links, auto index) HWY_ATTR {
        return hn::GatherIndex(d, &links->triangle, hn::BitCast(d, hn::Add(index, index)));
    };
    for (std::size_t i = 0; i < count; i += lanes) {
        // Lanes past the end refer to row 0, which exists.
        const auto pair = hn::IfThenElseZero(hn::FirstN(du, count - i), hn::LoadU(du, packed + i));
        const auto a = triangle_of(rows, hn::And(pair, hn::Set(du, 0xffffu)));
        const auto b = triangle_of(columns, hn::ShiftRight<16>(pair));
        hn::StoreInterleaved2(hn::Min(a, b), hn::Max(a, b), d, &out[i].a);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
