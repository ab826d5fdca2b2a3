#pragma once

// Rational numbers, as an independent check of exact arithmetic.

#include <boost/multiprecision/cpp_int.hpp>

#include "geometry/expansion.h"
#include "geometry/vec.h"

namespace crumple {

using Rational = boost::multiprecision::cpp_rational;

inline Rational value(TwoTerms x) { return Rational(x.high) + Rational(x.low); }

template <int N>
Rational value(const Expansion<N>& e) {
    Rational sum = 0;
    for (int i = 0; i < e.size; ++i) sum += Rational(e.term[i]);
    return sum;
}

inline Vec3<Rational> value(const Vec3d& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

}  // namespace crumple
