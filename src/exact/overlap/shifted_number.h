#pragma once

// Numbers that depend on the infinitesimal shift of the second surface (face_crossing.h): polynomials in e with
// rational coefficients, compared for e → 0+. They decide how points of segments lie in a face even if points coincide
// without the shift. They are slow, so only ties need them, and bodies that double words cannot represent. Host only.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "exact/overlap/exact_crossing.h"

namespace crumple {

class ShiftedNumber {
   public:
    ShiftedNumber() = default;
    explicit ShiftedNumber(Rational constant) { coefficients_.push_back(std::move(constant)); }
    explicit ShiftedNumber(double constant) : ShiftedNumber(Rational(constant)) {}
    /// Returns factor · e^power.
    static ShiftedNumber power(std::size_t power, Rational factor) {
        ShiftedNumber x;
        x.coefficients_.resize(power + 1);
        x.coefficients_[power] = std::move(factor);
        return x;
    }

    /// Returns the sign of the first coefficient that is not 0.
    int sign() const {
        for (const Rational& c : coefficients_)
            if (c != 0) return c.sign();
        return 0;
    }

    friend ShiftedNumber operator+(ShiftedNumber x, const ShiftedNumber& y) {
        x.coefficients_.resize(std::max(x.coefficients_.size(), y.coefficients_.size()));
        for (std::size_t i = 0; i < y.coefficients_.size(); ++i) x.coefficients_[i] += y.coefficients_[i];
        return x;
    }
    friend ShiftedNumber operator-(ShiftedNumber x) {
        for (Rational& c : x.coefficients_) c = -c;
        return x;
    }
    friend ShiftedNumber operator-(ShiftedNumber x, const ShiftedNumber& y) { return std::move(x) + -y; }
    friend ShiftedNumber operator*(const ShiftedNumber& x, const ShiftedNumber& y) {
        ShiftedNumber product;
        if (x.coefficients_.empty() || y.coefficients_.empty()) return product;
        product.coefficients_.resize(x.coefficients_.size() + y.coefficients_.size() - 1);
        for (std::size_t i = 0; i < x.coefficients_.size(); ++i)
            for (std::size_t j = 0; j < y.coefficients_.size(); ++j)
                product.coefficients_[i + j] += x.coefficients_[i] * y.coefficients_[j];
        return product;
    }

   private:
    std::vector<Rational> coefficients_;  ///< coefficients of e⁰, e¹, ...
};

}  // namespace crumple
