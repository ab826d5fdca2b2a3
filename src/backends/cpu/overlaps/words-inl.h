// Double words (unevaluated sums of two float64 numbers) in lanes, and vectors of three of them. geometry/double_word.h
// has the algorithms and their bounds.

#if defined(CRUMPLE_CPU_OVERLAPS_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_OVERLAPS_WORDS_INL_H_
#undef CRUMPLE_CPU_OVERLAPS_WORDS_INL_H_
#else
#define CRUMPLE_CPU_OVERLAPS_WORDS_INL_H_
#endif

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::overlaps {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

HWY_INLINE V set(double x) { return hn::Set(D(), x); }

struct Word {
    V high, low;
};

HWY_INLINE Word two_sum(V a, V b) {
    const V sum = hn::Add(a, b), b_part = hn::Sub(sum, a), a_part = hn::Sub(sum, b_part);
    return {sum, hn::Add(hn::Sub(a, a_part), hn::Sub(b, b_part))};
}
HWY_INLINE Word fast_two_sum(V a, V b) {
    const V sum = hn::Add(a, b);
    return {sum, hn::Sub(b, hn::Sub(sum, a))};
}
HWY_INLINE Word two_product(V a, V b) {
    const V product = hn::Mul(a, b);
#if HWY_TARGET <= HWY_AVX2 || HWY_TARGET == HWY_NEON
    return {product, hn::MulSub(a, b, product)};
#else
    const V splitter = set(0x1p27 + 1), scaled_a = hn::Mul(splitter, a), scaled_b = hn::Mul(splitter, b);
    const V a_high = hn::Sub(scaled_a, hn::Sub(scaled_a, a)), b_high = hn::Sub(scaled_b, hn::Sub(scaled_b, b));
    const V a_low = hn::Sub(a, a_high), b_low = hn::Sub(b, b_high);
    const V rest =
        hn::Sub(hn::Sub(hn::Sub(product, hn::Mul(a_high, b_high)), hn::Mul(a_low, b_high)), hn::Mul(a_high, b_low));
    return {product, hn::Sub(hn::Mul(a_low, b_low), rest)};
#endif
}

HWY_INLINE Word operator+(Word x, Word y) {
    const Word high = two_sum(x.high, y.high), low = two_sum(x.low, y.low);
    const Word middle = fast_two_sum(high.high, hn::Add(high.low, low.high));
    return fast_two_sum(middle.high, hn::Add(low.low, middle.low));
}
HWY_INLINE Word operator-(Word x) { return {hn::Neg(x.high), hn::Neg(x.low)}; }
HWY_INLINE Word operator-(Word x, Word y) { return x + -y; }
HWY_INLINE Word operator*(Word x, Word y) {
    const Word high = two_product(x.high, y.high);
    return fast_two_sum(high.high, hn::Add(high.low, hn::Add(hn::Mul(x.high, y.low), hn::Mul(x.low, y.high))));
}
HWY_INLINE Word operator/(Word x, Word y) {
    const V quotient = hn::Div(x.high, y.high);
    const Word first = two_product(y.high, quotient);
    const Word product = fast_two_sum(first.high, hn::Add(hn::Mul(y.low, quotient), first.low));
    const V remainder = hn::Add(hn::Sub(x.high, product.high), hn::Sub(x.low, product.low));
    return fast_two_sum(quotient, hn::Div(remainder, y.high));
}
/// Returns x times `factor`, which must be 0 or a power of two, of either sign. Exact.
HWY_INLINE Word scaled(Word x, V factor) { return {hn::Mul(x.high, factor), hn::Mul(x.low, factor)}; }

/// Vectors of three words, and of three bounds or magnitudes.
struct Words {
    Word x, y, z;
};
struct Sizes {
    V x, y, z;
};

HWY_INLINE Words operator+(const Words& p, const Words& q) { return {p.x + q.x, p.y + q.y, p.z + q.z}; }
HWY_INLINE Words operator-(const Words& p, const Words& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
HWY_INLINE Words operator*(Word s, const Words& p) { return {s * p.x, s * p.y, s * p.z}; }
HWY_INLINE Word dot(const Words& p, const Words& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
HWY_INLINE Words cross(const Words& p, const Words& q) {
    return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
HWY_INLINE Sizes size_of(const Words& p) { return {hn::Abs(p.x.high), hn::Abs(p.y.high), hn::Abs(p.z.high)}; }
HWY_INLINE Sizes operator+(const Sizes& p, const Sizes& q) {
    return {hn::Add(p.x, q.x), hn::Add(p.y, q.y), hn::Add(p.z, q.z)};
}
HWY_INLINE Sizes operator*(V s, const Sizes& p) { return {hn::Mul(s, p.x), hn::Mul(s, p.y), hn::Mul(s, p.z)}; }
HWY_INLINE Sizes operator*(double s, const Sizes& p) { return set(s) * p; }
HWY_INLINE V dot(const Sizes& p, const Sizes& q) {
    return hn::MulAdd(p.x, q.x, hn::MulAdd(p.y, q.y, hn::Mul(p.z, q.z)));
}
/// Returns upper bounds on the components of the cross product of vectors with these magnitudes, term by term.
HWY_INLINE Sizes cross(const Sizes& p, const Sizes& q) {
    return {hn::MulAdd(p.y, q.z, hn::Mul(p.z, q.y)), hn::MulAdd(p.z, q.x, hn::Mul(p.x, q.z)),
            hn::MulAdd(p.x, q.y, hn::Mul(p.y, q.x))};
}

/// Returns p − q, exactly, for points stored in one array per axis.
template <int size>
HWY_INLINE Words difference(const double (&p)[3][size], const double (&q)[3][size], int i) {
    const D d;
    const auto on = [&](int axis)
                        HWY_ATTR { return two_sum(hn::Load(d, p[axis] + i), hn::Neg(hn::Load(d, q[axis] + i))); };
    return {on(0), on(1), on(2)};
}
template <int size>
HWY_INLINE Words difference(const double (&p)[3][size], const Vec3d& q, int i) {
    const D d;
    return {two_sum(hn::Load(d, p[0] + i), set(-q.x)), two_sum(hn::Load(d, p[1] + i), set(-q.y)),
            two_sum(hn::Load(d, p[2] + i), set(-q.z))};
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::overlaps
HWY_AFTER_NAMESPACE();

#endif
