#pragma once

// Real roots in [0, 1] of polynomials over the integers: found, told apart, asked for signs, rounded; all exactly.

#include <utility>
#include <vector>

#include "exact/impact/polynomial.h"

namespace crumple {

/// A root in [0, 1] of some polynomial: a dyadic number, or an open interval that holds this root of it and no other,
/// with other signs at its ends. What it is asked makes the interval shorter, as far as the answer needs it.
class Root {
   public:
    /// The number itself.
    explicit Root(Dyadic exact) : at_(std::move(exact)) {}
    /// The one root of p between `from` and (k + 1) / 2^j, a simple one; there is none at the ends.
    Root(const Polynomial& p, Dyadic from) : polynomial_(p), at_(std::move(from)), below_(p.sign_at(at_)) {}

    /// The sign of another polynomial there.
    int sign(const Polynomial& q);
    /// The largest float64 number that is not above.
    double rounded_down();
    bool is_zero() const { return exact() && at_.k == 0; }

   private:
    bool exact() const { return below_ == 0; }
    void halve();

    Polynomial polynomial_;  ///< 0 if exact
    Dyadic at_;              ///< the number, or the lower end of the interval of length 2^-j
    int below_ = 0;          ///< the polynomial's sign at the lower end; 0 if exact
};

/// The distinct roots in [0, 1], in ascending order; p is not 0.
std::vector<Root> roots_in_unit_interval(const Polynomial& p);

}  // namespace crumple
