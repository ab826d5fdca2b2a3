// Membership of balls in clusters (stage `subdivide`), a vector of balls at a time.
//
// Two passes over the centres. The first finds the nearest centre. The second first asks the looser but cheaper rule
// d_k <= d_min + 2 r, as d_k^2 <= (d_min + 2 r)^2, which nearly all centres fail for all balls of a vector, since
// neighbours in the array tend to be neighbours in space; only the few left pay for the bisector rule, whose factor
// |v_k - v_nearest| has to be gathered.

#if defined(CRUMPLE_CPU_SIMD_ASSIGN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_ASSIGN_INL_H_
#undef CRUMPLE_CPU_SIMD_ASSIGN_INL_H_
#else
#define CRUMPLE_CPU_SIMD_ASSIGN_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

inline void assign(const float* x, const float* y, const float* z, const float* r, std::int64_t n,
                   const Centres& centres, std::uint64_t* mask) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    using V = hn::Vec<decltype(d)>;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));

    alignas(64) float reach[max_clusters][max_clusters];  // [k][nearest]
    for (int k = 0; k < centres.count; ++k)
        for (int j = 0; j < centres.count; ++j) {
            const Vec3f between = centres[k] - centres[j];
            reach[k][j] = 2.00001f * std::sqrt(dot(between, between)) + 1e-22f;
        }
    HWY_ALIGN float d2[max_clusters * hn::MaxLanes(d)];
    // The last vector starts earlier and writes some masks a second time.
    for (std::int64_t begin = 0; begin < n; begin += lanes) {
        const std::int64_t i = n >= lanes ? std::min(begin, n - lanes) : 0;
        V px, py, pz, pr;
        if (n >= lanes) {
            px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i), pz = hn::LoadU(d, z + i), pr = hn::LoadU(d, r + i);
        } else {
            HWY_ALIGN float few[4][hn::MaxLanes(d)] = {};
            for (std::int64_t l = 0; l < n; ++l) few[0][l] = x[l], few[1][l] = y[l], few[2][l] = z[l], few[3][l] = r[l];
            px = hn::Load(d, few[0]), py = hn::Load(d, few[1]), pz = hn::Load(d, few[2]), pr = hn::Load(d, few[3]);
        }
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
        const V tight = hn::Mul(best, hn::Set(d, 1.000002f));
        auto low = hn::Zero(du), high = hn::Zero(du);
        for (int k = 0; k < centres.count; ++k) {
            const V distance = hn::Load(d, d2 + static_cast<std::size_t>(k) * hn::MaxLanes(d));
            const auto near = hn::Le(distance, loose);
            if (hn::AllFalse(d, near)) continue;
            const auto member = hn::Le(distance, hn::MulAdd(pr, hn::GatherIndex(d, reach[k], nearest), tight));
            const auto bit = hn::IfThenElseZero(hn::RebindMask(du, member), hn::Set(du, std::uint32_t{1} << (k % 32)));
            if (k < 32)
                low = hn::Or(low, bit);
            else
                high = hn::Or(high, bit);
        }
        HWY_ALIGN std::uint32_t halves[2 * hn::MaxLanes(d)];
        hn::StoreInterleaved2(low, high, du, halves);
        std::memcpy(mask + i, halves, sizeof(std::uint64_t) * static_cast<std::size_t>(std::min(lanes, n)));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
