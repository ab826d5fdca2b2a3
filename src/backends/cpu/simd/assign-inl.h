// Membership of balls in clusters (stage `subdivide`), a vector of balls at a time.
//
// Let d_k be the distance of a ball's centre from cluster centre v_k, d_min the least of these distances, and r the
// ball's radius. The first pass over the cluster centres finds the nearest one. If there are many, a looser but cheaper
// rule than the bisector rule (joins() in geometry/ball.h) comes first: d_k <= d_min + 2 r, as d_k^2 <= (d_min + 2
// r)^2. Nearly all cluster centres fail it for all balls of a vector, since neighbours in the array tend to be
// neighbours in space. The few that are left become the bits of an integer, so that only the exit of the loop over them
// is mispredicted. The bisector rule decides these; its factor |v_k - v_nearest| is gathered. If there are few cluster
// centres, as in the second level, the bisector rule decides all of them without a loop over bits: the factors of one
// cluster centre fit a register.

#if defined(CRUMPLE_CPU_SIMD_ASSIGN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_ASSIGN_INL_H_
#undef CRUMPLE_CPU_SIMD_ASSIGN_INL_H_
#else
#define CRUMPLE_CPU_SIMD_ASSIGN_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <limits>

#include "backends/cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

inline void assign(const Ball* ball, std::int64_t n, const Centres& centres, std::uint64_t* mask, std::int64_t* count) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(d)>;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));

    alignas(64) float reach[max_clusters][max_clusters];  // [k][nearest]
    for (int k = 0; k < centres.count; ++k)
        for (int j = 0; j < centres.count; ++j) reach[k][j] = bisector_radius_factor(centres[k] - centres[j]);
    const bool few = centres.count <= lanes;
    HWY_ALIGN float d2[max_clusters * hn::MaxLanes(d)];
    for (std::int64_t i = 0; i < n; i += lanes) {
        V px, py, pz, pr;
        hn::LoadInterleaved4(d, reinterpret_cast<const float*>(ball + i), px, py, pz, pr);
        V best = hn::Set(d, std::numeric_limits<float>::infinity());
        auto nearest = hn::Zero(di);
        for (int k = 0; k < centres.count; ++k) {
            const auto c = static_cast<std::size_t>(k);
            const V dx = hn::Sub(px, hn::Set(d, centres.x[c]));
            const V dy = hn::Sub(py, hn::Set(d, centres.y[c]));
            const V dz = hn::Sub(pz, hn::Set(d, centres.z[c]));
            const V distance = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
            hn::Store(distance, d, d2 + c * hn::MaxLanes(d));
            const auto closer = hn::Lt(distance, best);
            nearest = hn::IfThenElse(hn::RebindMask(di, closer), hn::Set(di, k), nearest);
            best = hn::Min(distance, best);
        }
        const V root = hn::MulAdd(hn::Set(d, 2.0f), pr, hn::Sqrt(best));
        const V loose = hn::Mul(hn::Mul(root, root), hn::Set(d, 1.00001f));
        const V tight = hn::Mul(best, hn::Set(d, bisector_factor));
        const auto distance_to = [&](int k) { return hn::Load(d, d2 + static_cast<std::size_t>(k) * hn::MaxLanes(d)); };
        auto low = hn::Zero(du), high = hn::Zero(du);
        const auto valid = hn::FirstN(d, static_cast<std::size_t>(n - i));
        const auto join = [&](int k, V factor) HWY_ATTR {
            const auto member = hn::And(valid, hn::Le(distance_to(k), hn::MulAdd(pr, factor, tight)));
            count[k] += static_cast<std::int64_t>(hn::CountTrue(d, member));
            const auto bit = hn::IfThenElseZero(hn::RebindMask(du, member), hn::Set(du, std::uint32_t{1} << (k % 32)));
            if (k < 32)
                low = hn::Or(low, bit);
            else
                high = hn::Or(high, bit);
        };
        if (few) {
            const auto lookup = hn::IndicesFromVec(d, nearest);
            for (int k = 0; k < centres.count; ++k) join(k, hn::TableLookupLanes(hn::Load(d, reach[k]), lookup));
        } else {
            std::uint64_t near = 0;
            for (int k = 0; k < centres.count; ++k)
                near |= static_cast<std::uint64_t>(!hn::AllFalse(d, hn::Le(distance_to(k), loose))) << k;
            for (; near; near &= near - 1) {
                const int k = std::countr_zero(near);
                join(k, hn::GatherIndex(d, reach[k], nearest));
            }
        }
        if (i + lanes <= n) {
            hn::StoreInterleaved2(low, high, du, reinterpret_cast<std::uint32_t*>(mask + i));
        } else {
            HWY_ALIGN std::uint32_t halves[2 * hn::MaxLanes(d)];
            hn::StoreInterleaved2(low, high, du, halves);
            std::memcpy(mask + i, halves, sizeof(std::uint64_t) * static_cast<std::size_t>(n - i));
        }
    }
}

inline std::int64_t list_members(const std::uint64_t* mask, std::int64_t begin, std::int64_t end, int child,
                                 std::int32_t* HWY_RESTRICT member) {
    const hn::ScalableTag<std::int32_t> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    const std::uint64_t bit = std::uint64_t{1} << child;
    const auto low_bit = hn::Set(du, static_cast<std::uint32_t>(bit)),
               high_bit = hn::Set(du, static_cast<std::uint32_t>(bit >> 32)), none = hn::Zero(du);
    const auto iota = hn::Iota(d, 0);
    // Masks of the last, incomplete vector are copied: another thread may be writing the masks past `end`.
    HWY_ALIGN std::uint64_t rest[hn::MaxLanes(d)] = {};
    const std::int64_t whole = end - (end - begin) % lanes;
    std::copy(mask + whole, mask + end, rest);
    std::size_t count = 0;
    for (std::int64_t m = begin; m < end; m += lanes) {
        hn::Vec<decltype(du)> low, high;
        hn::LoadInterleaved2(du, reinterpret_cast<const std::uint32_t*>(m < whole ? mask + m : rest), low, high);
        const auto has_bit = hn::Ne(hn::Or(hn::And(low, low_bit), hn::And(high, high_bit)), none);
        const auto listed = hn::RebindMask(d, has_bit);
        count += compress_to(d, hn::Add(iota, hn::Set(d, static_cast<std::int32_t>(m))), listed, member + count);
    }
    return static_cast<std::int64_t>(count);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
