#pragma once

// Univariate polynomials over the integers. Coordinates, normals and volumes of moving points are such polynomials of
// time.
//
// Degrees are at most about six, so the simplest methods are the fastest. All integer divisions are exact.

#include <span>
#include <vector>

#include "exact/integer.h"

namespace crumple {

/// Dyadic number k / 2^j, j >= 0, at which polynomials are evaluated.
struct Dyadic {
    Integer k;
    unsigned j = 0;
};

class Polynomial {
   public:
    Polynomial() = default;  ///< makes the polynomial 0
    /// Constructs from coefficients in ascending order; drops zeros at the end.
    explicit Polynomial(std::vector<Integer> coefficients);

    bool zero() const { return coefficients_.empty(); }
    /// Returns the degree; −1 for the polynomial 0.
    int degree() const { return static_cast<int>(coefficients_.size()) - 1; }
    const std::vector<Integer>& coefficients() const { return coefficients_; }

    /// Returns the sign at t: −1, 0 or 1.
    int sign_at(const Dyadic& t) const;
    /// Returns a positive multiple of p((k + u) / 2^j) for t = k / 2^j, as a polynomial in u.
    Polynomial zoomed(const Dyadic& t) const;

    Polynomial derivative() const;
    /// Returns the polynomial divided by the greatest common divisor of its coefficients.
    Polynomial primitive() const;

    friend Polynomial operator+(const Polynomial& p, const Polynomial& q);
    friend Polynomial operator-(const Polynomial& p, const Polynomial& q);
    friend Polynomial operator*(const Polynomial& p, const Polynomial& q);

   private:
    void trim();

    std::vector<Integer> coefficients_;
};

/// Returns the primitive polynomial of highest degree that divides all; 0 if all are 0.
Polynomial greatest_common_divisor(std::span<const Polynomial> polynomials);

/// Returns the primitive polynomial with the same roots, all simple; p is not 0.
Polynomial square_free(const Polynomial& p);

/// Returns the number of sign changes in the Bernstein coefficients of p over [0, 1], without zeros.
///
/// By Descartes' rule this is the number of roots in the open interval (0, 1), counted with multiplicity, plus an even
/// number. So 0 means no root, and 1 means one simple root.
int sign_variations(const Polynomial& p);

/// Returns the sign of p on all of [0, 1] if its Bernstein coefficients, whose hull contains p, all have it; otherwise
/// 0.
int sign_on_unit_interval(const Polynomial& p);

}  // namespace crumple
