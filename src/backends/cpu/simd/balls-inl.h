// Balls around triangles or, if they move, around their swept volumes (stage `bounds`), one triangle in each block of
// 128 bits; and a test for repeated vertices, a vector of triangles at a time.

#if defined(CRUMPLE_CPU_SIMD_BALLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_BALLS_INL_H_
#undef CRUMPLE_CPU_SIMD_BALLS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_BALLS_INL_H_
#endif

#include "backends/cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

/// Computes balls (StageKernels::balls). `stop`: the positions at the end of the step; read only if `moving`.
template <bool moving, class Points>
HWY_INLINE void balls_from(const Points& points, const Points& stop, const std::int32_t* HWY_RESTRICT corners,
                           std::int64_t begin, std::int64_t end, float more, Ball* HWY_RESTRICT ball) {
    const hn::ScalableTag<float> d;
    using V = hn::Vec<decltype(d)>;
    const V share = hn::Set(d, moving ? 1.0f / 6.0f : 1.0f / 3.0f), factor = hn::Set(d, ball_factor),
            slack = hn::Set(d, ball_slack), added = hn::Set(d, more);
    HWY_ALIGN static constexpr std::uint32_t last_lane[4] = {0, 0, 0, ~0u};
    const auto is_radius =
        hn::MaskFromVec(hn::BitCast(d, hn::LoadDup128(hn::RebindToUnsigned<decltype(d)>(), last_lane)));
    for (std::int64_t t = begin; t < end; t += blocks) {
        const std::int32_t* corner[blocks];
        for (int b = 0; b < blocks; ++b) {
            // Prefetches the vertices of later triangles: another core may just have written many of them.
            const std::int32_t* ahead = corners + 3 * std::min(t + b + 32, end - 1);
            for (int k = 0; k < 3; ++k) {
                hwy::Prefetch(points.row(ahead[k]));
                if (moving) hwy::Prefetch(stop.row(ahead[k]));
            }
            corner[b] = corners + 3 * std::min(t + b, end - 1);
        }
        const V p0 = points.position(d, corner, 0), p1 = points.position(d, corner, 1),
                p2 = points.position(d, corner, 2);
        V q0 = p0, q1 = p1, q2 = p2, sum = hn::Add(p0, hn::Add(p1, p2));
        if constexpr (moving) {
            q0 = stop.position(d, corner, 0), q1 = stop.position(d, corner, 1), q2 = stop.position(d, corner, 2);
            sum = hn::Add(sum, hn::Add(q0, hn::Add(q1, q2)));
        }
        const V centre = hn::Mul(share, sum);
        const auto distance2 = [&](V p) HWY_ATTR {
            const V q = hn::Sub(p, centre);
            return sum_of(hn::Mul(q, q));
        };
        V farthest2 = hn::Max(distance2(p0), hn::Max(distance2(p1), distance2(p2)));
        if constexpr (moving)
            farthest2 = hn::Max(farthest2, hn::Max(distance2(q0), hn::Max(distance2(q1), distance2(q2))));
        const V radius = hn::Add(hn::MulAdd(hn::Sqrt(farthest2), factor, slack), added);
        hn::StoreU(hn::IfThenElse(is_radius, radius, centre), d, &ball[t].x);
    }
}

template <class Points, class T>
HWY_INLINE void balls_of(const T* rows, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                         std::int64_t ends, float more, Ball* ball) {
    const Points start(rows), stop(rows + 4 * ends);
    if (ends)
        balls_from<true>(start, stop, corners, begin, end, more, ball);
    else
        balls_from<false>(start, stop, corners, begin, end, more, ball);
}

inline void balls(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                  std::int64_t ends, float more, Ball* ball) {
    if (points.f)
        balls_of<Points32>(points.f, corners, begin, end, ends, more, ball);
    else
        balls_of<Points64>(points.d, corners, begin, end, ends, more, ball);
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
