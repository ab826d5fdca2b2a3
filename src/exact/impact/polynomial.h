#pragma once

// Polynomials in one unknown over the integers: what becomes of coordinates, normals and volumes when points move.
//
// Degrees are at most some six, and products of sums of products are all that is made of them, so the plainest methods
// are the fastest. No division leaves a remainder.

#include <span>
#include <vector>

#include "exact/integer.h"

namespace crumple {

/// k / 2^j, j >= 0: where polynomials are evaluated.
struct Dyadic {
    Integer k;
    unsigned j = 0;
};

class Polynomial {
   public:
    Polynomial() = default;  ///< 0
    /// Of coefficients from the constant one up; zeros at the end are dropped.
    explicit Polynomial(std::vector<Integer> coefficients);

    bool zero() const { return coefficients_.empty(); }
    /// −1 for 0.
    int degree() const { return static_cast<int>(coefficients_.size()) - 1; }
    const std::vector<Integer>& coefficients() const { return coefficients_; }

    /// −1, 0 or 1.
    int sign_at(const Dyadic& t) const;
    /// A positive multiple of p((k + u) / 2^j), as a polynomial in u.
    Polynomial zoomed(const Dyadic& t) const;

    Polynomial derivative() const;
    /// Divided by the greatest common divisor of the coefficients.
    Polynomial primitive() const;

    friend Polynomial operator+(const Polynomial& p, const Polynomial& q);
    friend Polynomial operator-(const Polynomial& p, const Polynomial& q);
    friend Polynomial operator*(const Polynomial& p, const Polynomial& q);

   private:
    void trim();

    std::vector<Integer> coefficients_;
};

/// The polynomial of highest degree that divides all, primitive; 0 if all are 0.
Polynomial greatest_common_divisor(std::span<const Polynomial> polynomials);

/// The polynomial with the same roots, each of them simple, primitive; p is not 0.
Polynomial square_free(const Polynomial& p);

/// How often the sign changes along the Bernstein coefficients of p over [0, 1], zeros skipped.
///
/// By Descartes' rule it is the number of roots in the open interval (0, 1), each counted as often as it is one, plus
/// an even number. So 0 is none, and 1 is one simple root.
int sign_variations(const Polynomial& p);

/// The sign of p on all of [0, 1] where its Bernstein coefficients show it, else 0: p lies within their hull.
int sign_on_unit_interval(const Polynomial& p);

}  // namespace crumple
