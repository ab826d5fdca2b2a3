// Squared distances of static features, one pair per lane: SIMD version of the usual case of
// exact/proximity/enclosure.h. A counterpart of a function there computes the same for each lane. Pairs that need more
// (a refined guess, exact sums), or that touch, yield NaN.

#if defined(CRUMPLE_NEAR_CPU_SQUARED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_NEAR_CPU_SQUARED_INL_H_
#undef CRUMPLE_NEAR_CPU_SQUARED_INL_H_
#else
#define CRUMPLE_NEAR_CPU_SQUARED_INL_H_
#endif

#include <limits>

#include "exact/proximity/enclosure.h"
#include "exact/proximity/guess_batch.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::near {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Without a fused multiply-add, a product's error takes seventeen operations, and two lanes would gain nothing.
#if HWY_HAVE_FLOAT64 && HWY_NATIVE_FMA

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

HWY_INLINE V set(double x) { return hn::Set(D(), x); }

struct Double {
    V high, low;
};
struct Vector {
    V x, y, z;
};
struct DoubleVector {
    Double x, y, z;
};

HWY_INLINE Double two_sum(V a, V b) {
    const V sum = hn::Add(a, b);
    const V b_part = hn::Sub(sum, a), a_part = hn::Sub(sum, b_part);
    return {sum, hn::Add(hn::Sub(a, a_part), hn::Sub(b, b_part))};
}
HWY_INLINE Double two_product(V a, V b) {
    const V product = hn::Mul(a, b);
    return {product, hn::MulSub(a, b, product)};
}

HWY_INLINE Vector high(const DoubleVector& p) { return {p.x.high, p.y.high, p.z.high}; }
HWY_INLINE V dot(const Vector& p, const Vector& q) {
    return hn::MulAdd(p.x, q.x, hn::MulAdd(p.y, q.y, hn::Mul(p.z, q.z)));
}
HWY_INLINE V length_1(const Vector& p) { return hn::Add(hn::Abs(p.x), hn::Add(hn::Abs(p.y), hn::Abs(p.z))); }
HWY_INLINE V largest(const Vector& p) { return hn::Max(hn::Abs(p.x), hn::Max(hn::Abs(p.y), hn::Abs(p.z))); }

/// Counterpart of detail::combine().
HWY_INLINE Double combine(Double w, V s, Double u, V t, Double v) {
    const Double su = two_product(s, u.high), tv = two_product(t, v.high);
    const Double first = two_sum(w.high, su.high), both = two_sum(first.high, tv.high);
    const V low = hn::Add(w.low, hn::Add(hn::MulAdd(s, u.low, su.low), hn::MulAdd(t, v.low, tv.low)));
    return two_sum(both.high, hn::Add(hn::Add(first.low, both.low), low));
}

/// Counterpart of detail::dot_product() of a vector with itself.
HWY_INLINE Double square(const DoubleVector& p) {
    const Double x = two_product(p.x.high, p.x.high), y = two_product(p.y.high, p.y.high),
                 z = two_product(p.z.high, p.z.high);
    const Double xy = two_sum(x.high, y.high), xyz = two_sum(xy.high, z.high);
    const auto low = [](const Double& square, const Double& of)
                         HWY_ATTR { return hn::MulAdd(hn::Add(of.high, of.high), of.low, square.low); };
    const V lows = hn::Add(hn::Add(low(x, p.x), low(y, p.y)), low(z, p.z));
    return two_sum(xyz.high, hn::Add(hn::Add(xy.low, xyz.low), lows));
}

/// Returns the exact differences of two columns of points, from `first` on.
HWY_INLINE DoubleVector difference(const GuessBatch::Column (&p)[3], const GuessBatch::Column (&q)[3],
                                   std::size_t first) {
    const auto on_axis = [&](int axis) HWY_ATTR {
        return two_sum(hn::Load(D(), p[axis] + first), hn::Neg(hn::Load(D(), q[axis] + first)));
    };
    return {on_axis(0), on_axis(1), on_axis(2)};
}

/// Counterpart of Enclosure::rounded_slope() and Slope::pull().
HWY_INLINE V pull(const Vector& g, V error, const Vector& along, V length, hn::Mask<D> free) {
    const V of_g = hn::MulAdd(set(6 * detail::near_epsilon), largest(g), hn::Mul(set(1.1), error));
    const V value = dot(g, along), off = hn::MulAdd(of_g, length, set(detail::slope_slack));
    const auto none = hn::Or(hn::Eq(length, hn::Zero(D())), hn::AndNot(free, hn::Ge(value, off)));
    return hn::IfThenZeroElse(none, hn::Add(hn::Abs(value), off));
}

HWY_INLINE V squared_distances(const GuessBatch& batch, std::size_t first) {
    constexpr double epsilon = detail::near_epsilon;
    const V zero = hn::Zero(D()), s = hn::Load(D(), batch.s + first), t = hn::Load(D(), batch.t + first);
    const V free = hn::Load(D(), batch.free + first);
    const auto free_s = hn::Gt(free, zero), free_t = hn::Gt(free, set(1));
    const DoubleVector exact_w = difference(batch.x0, batch.y0, first), exact_u = difference(batch.x1, batch.x0, first),
                       exact_v = difference(batch.v1, batch.v0, first);
    const Vector w = high(exact_w), u = high(exact_u), v = high(exact_v);
    const V w_length = length_1(w), u_length = length_1(u), v_length = length_1(v);

    const DoubleVector exact_g{combine(exact_w.x, s, exact_u.x, t, exact_v.x),
                               combine(exact_w.y, s, exact_u.y, t, exact_v.y),
                               combine(exact_w.z, s, exact_u.z, t, exact_v.z)};
    const Vector g = high(exact_g);
    const V terms = hn::Add(w_length, hn::MulAdd(s, u_length, hn::Mul(t, v_length)));
    const V error = hn::IfThenElseZero(free_s, hn::Mul(set(17 * epsilon * epsilon), terms));

    const V by_u = pull(g, error, u, u_length, free_s), by_v = pull(g, error, v, v_length, free_t);
    const V uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), product = hn::Mul(uu, vv);
    const V area = hn::NegMulAdd(set(32 * epsilon), product, hn::NegMulAdd(uv, uv, product));
    const V least = set(detail::least_squared);
    const V uncurved = hn::Mul(set(2.1), hn::Add(by_u, by_v));
    const V by_edge = hn::Div(hn::Mul(set(1.1), hn::Mul(by_u, by_u)), uu);
    const V by_area =
        hn::Div(hn::Mul(set(2.25), hn::MulAdd(hn::Mul(by_u, by_u), vv, hn::Mul(hn::Mul(by_v, by_v), uu))), area);
    const auto one_edge = hn::Eq(v_length, zero);
    const auto curved = hn::And(hn::Gt(uu, least), hn::Or(one_edge, hn::And(hn::Gt(vv, least), hn::Gt(area, zero))));
    const V by_curve = hn::Min(uncurved, hn::IfThenElse(one_edge, by_edge, by_area));
    const V loss = hn::IfThenZeroElse(hn::Eq(hn::Add(by_u, by_v), zero), hn::IfThenElse(curved, by_curve, uncurved));

    const Double squared = square(exact_g);
    const V above =
        hn::MulAdd(set(32 * epsilon * epsilon), squared.high, hn::Mul(hn::MulAdd(set(2.1), length_1(g), error), error));
    const V below = hn::Add(above, loss);
    const V rounded = hn::Add(squared.high, hn::Add(squared.low, above));
    const auto rounds = hn::Eq(rounded, hn::Add(squared.high, hn::Sub(squared.low, below)));
    const auto in_range = hn::And(hn::Le(hn::Add(w_length, hn::Add(u_length, v_length)), set(detail::largest_size)),
                                  hn::Ge(squared.high, least));
    const auto apart = hn::Lt(below, hn::Mul(set(0.5), squared.high));
    return hn::IfThenElse(hn::And(rounds, hn::And(in_range, apart)), rounded,
                          set(std::numeric_limits<double>::quiet_NaN()));
}

inline void squared(const GuessBatch& batch, double* squared) {
    constexpr std::size_t lanes = hn::MaxLanes(D());
    static_assert(GuessBatch::most % lanes == 0);
    for (std::size_t first = 0; first < batch.count; first += lanes)
        hn::StoreU(squared_distances(batch, first), D(), squared + first);
}

#else

inline void squared(const GuessBatch& batch, double* squared) { leave_unresolved(batch, squared); }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::near
HWY_AFTER_NAMESPACE();

#endif
