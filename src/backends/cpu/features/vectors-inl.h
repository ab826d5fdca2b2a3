// Arithmetic on one three-dimensional vector per lane, for the filters of queries about features.

#if defined(CRUMPLE_FEATURES_CPU_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_FEATURES_CPU_VECTORS_INL_H_
#undef CRUMPLE_FEATURES_CPU_VECTORS_INL_H_
#else
#define CRUMPLE_FEATURES_CPU_VECTORS_INL_H_
#endif

#include "backends/cpu/simd/corners-inl.h"
#include "filters/features/length.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

template <class V>
HWY_INLINE Point<V> add(const Point<V>& a, const Point<V>& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Point<V> subtract(const Point<V>& a, const Point<V>& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Point<V> abs(const Point<V>& a) {
    return {hn::Abs(a.x), hn::Abs(a.y), hn::Abs(a.z)};
}
template <class V>
HWY_INLINE Point<V> max(const Point<V>& a, const Point<V>& b) {
    return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)};
}
template <class V>
HWY_INLINE V dot(const Point<V>& a, const Point<V>& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
/// Returns the length of one vector per lane, with the error bounds of length() in filters/features/length.h.
template <class V>
HWY_INLINE V length(const Point<V>& a) {
    const V z = hn::MulAdd(a.z, a.z, hn::Set(hn::DFromV<V>(), least_square));
    return hn::Sqrt(hn::MulAdd(a.x, a.x, hn::MulAdd(a.y, a.y, z)));
}
template <class V>
HWY_INLINE Point<V> cross(const Point<V>& a, const Point<V>& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
/// Returns, for each component of a x b, the sum of its two products instead of their difference.
template <class V>
HWY_INLINE Point<V> product_magnitudes(const Point<V>& a, const Point<V>& b) {
    return {hn::MulAdd(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulAdd(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulAdd(a.x, b.y, hn::Mul(a.y, b.x))};
}
template <class V>
HWY_INLINE V least(V a, V b, V c) {
    return hn::Min(a, hn::Min(b, c));
}
template <class V>
HWY_INLINE V greatest(V a, V b, V c) {
    return hn::Max(a, hn::Max(b, c));
}

/// Returns the sum of three points b minus the sum of three points a.
template <class V>
HWY_INLINE Point<V> between_centroids(const Point<V>* a, const Point<V>* b) {
    return subtract(add(add(b[0], b[1]), b[2]), add(add(a[0], a[1]), a[2]));
}

/// Computes the extent of three points along direction n.
template <class V>
HWY_INLINE void extent(const Point<V>& n, const Point<V>* p, V& low, V& high) {
    const V p0 = dot(n, p[0]), p1 = dot(n, p[1]), p2 = dot(n, p[2]);
    low = least(p0, p1, p2);
    high = greatest(p0, p1, p2);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();

#endif
