// Balls around triangles (stage `bounds`), one triangle in each block of 128 bits. And whether triangles name a vertex
// twice, a vector of triangles at a time.

#if defined(CRUMPLE_CPU_SIMD_BALLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_BALLS_INL_H_
#undef CRUMPLE_CPU_SIMD_BALLS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_BALLS_INL_H_
#endif

#include "engine/cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

template <class Points>
HWY_INLINE void balls_from(const Points& points, const std::int32_t* HWY_RESTRICT corners, std::int64_t begin,
                           std::int64_t end, Ball* HWY_RESTRICT ball) {
    const hn::ScalableTag<float> d;
    using V = hn::Vec<decltype(d)>;
    const V third = hn::Set(d, 1.0f / 3.0f), factor = hn::Set(d, ball_factor), slack = hn::Set(d, ball_slack);
    HWY_ALIGN static constexpr std::uint32_t last_lane[4] = {0, 0, 0, ~0u};
    const auto is_radius =
        hn::MaskFromVec(hn::BitCast(d, hn::LoadDup128(hn::RebindToUnsigned<decltype(d)>(), last_lane)));
    for (std::int64_t t = begin; t < end; t += blocks) {
        const std::int32_t* corner[blocks];
        for (int b = 0; b < blocks; ++b) {
            // Many corners were written by another core just now.
            const std::int32_t* ahead = corners + 3 * std::min(t + b + 32, end - 1);
            for (int k = 0; k < 3; ++k) hwy::Prefetch(points.row(ahead[k]));
            corner[b] = corners + 3 * std::min(t + b, end - 1);
        }
        const V p0 = points.position(d, corner, 0), p1 = points.position(d, corner, 1),
                p2 = points.position(d, corner, 2);
        const V centre = hn::Mul(third, hn::Add(p0, hn::Add(p1, p2)));
        const auto distance2 = [&](V p) HWY_ATTR {
            const V q = hn::Sub(p, centre);
            return sum_of(hn::Mul(q, q));
        };
        const V radius = hn::Sqrt(hn::Max(distance2(p0), hn::Max(distance2(p1), distance2(p2))));
        hn::StoreU(hn::IfThenElse(is_radius, hn::MulAdd(radius, factor, slack), centre), d, &ball[t].x);
    }
}

inline void balls(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                  Ball* ball) {
    if (points.f)
        balls_from(Points32(points.f), corners, begin, end, ball);
    else
        balls_from(Points64(points.d), corners, begin, end, ball);
}

inline bool repeats_corner(const std::int32_t* HWY_RESTRICT corners, std::int64_t begin, std::int64_t end) {
    const hn::ScalableTag<std::int32_t> d;
    using V = hn::Vec<decltype(d)>;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    auto repeats = hn::FirstN(d, 0);
    std::int64_t t = begin;
    for (; t + lanes <= end; t += lanes) {
        V a, b, c;
        hn::LoadInterleaved3(d, corners + 3 * t, a, b, c);
        repeats = hn::Or(repeats, hn::Or(hn::Eq(a, b), hn::Or(hn::Eq(b, c), hn::Eq(c, a))));
    }
    return !hn::AllFalse(d, repeats) || scalar_stages.repeats_corner(corners, t, end);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
