// Balls around triangles (stage `bounds`), one triangle at a time.

#if defined(CRUMPLE_CPU_SIMD_BALLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_BALLS_INL_H_
#undef CRUMPLE_CPU_SIMD_BALLS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_BALLS_INL_H_
#endif

#include "cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

template <class Points>
HWY_INLINE void balls_from(const Points& points, const std::int32_t* HWY_RESTRICT corners, std::int64_t begin,
                           std::int64_t end, Ball* HWY_RESTRICT ball) {
    const Four d;
    const V4 third = hn::Set(d, 1.0f / 3.0f), factor = hn::Set(d, ball_factor), slack = hn::Set(d, ball_slack);
    const auto xyz = hn::FirstN(d, 3);
    for (std::int64_t t = begin; t < end; ++t) {
        const V4 p0 = points.load_float(corners[3 * t]), p1 = points.load_float(corners[3 * t + 1]),
                 p2 = points.load_float(corners[3 * t + 2]);
        const V4 centre = hn::Mul(third, hn::Add(p0, hn::Add(p1, p2)));
        const auto distance2 = [&](V4 p) {
            const V4 q = hn::Sub(p, centre);
            return sum_of(hn::Mul(q, q));
        };
        const V4 radius = hn::Sqrt(hn::Max(distance2(p0), hn::Max(distance2(p1), distance2(p2))));
        hn::Store(hn::IfThenElse(xyz, centre, hn::MulAdd(radius, factor, slack)), d, &ball[t].x);
    }
}

inline void balls(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                  Ball* ball) {
    if (points.f)
        balls_from(Points32{points.f}, corners, begin, end, ball);
    else
        balls_from(Points64{points.d}, corners, begin, end, ball);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
