#pragma once

// Real roots in [0, 1] of polynomials over the integers, all exact: isolates roots, decides signs at them, and rounds
// them.

#include <utility>
#include <vector>

#include "exact/impact/polynomial.h"

namespace crumple {

/// Root in [0, 1] of some polynomial: a dyadic number, or an open interval that contains this root and no other, with
/// opposite signs at its ends. Member functions shorten the interval as far as their result requires.
class Root {
   public:
    /// Constructs a root that is a dyadic number.
    explicit Root(Dyadic exact) : at_(std::move(exact)) {}
    /// Constructs the only root of p between `from` = k / 2^j and (k + 1) / 2^j. It must be simple, and there must be
    /// none at the ends.
    Root(const Polynomial& p, Dyadic from) : polynomial_(p), at_(std::move(from)), below_(p.sign_at(at_)) {}

    /// Returns the sign of another polynomial at the root.
    int sign(const Polynomial& q);
    /// Returns the largest float64 not above the root.
    double rounded_down();
    bool is_zero() const { return exact() && at_.k == 0; }

   private:
    bool exact() const { return below_ == 0; }
    void halve();

    Polynomial polynomial_;  ///< polynomial with this root; 0 if the root is a dyadic number
    Dyadic at_;              ///< the number, or the lower end of the interval of length 2^-j
    int below_ = 0;          ///< the polynomial's sign at the lower end; 0 if the root is a dyadic number
};

/// Returns the distinct roots of p in [0, 1], in ascending order; p is not 0.
std::vector<Root> roots_in_unit_interval(const Polynomial& p);

}  // namespace crumple
