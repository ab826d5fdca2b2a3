#pragma once

// Sums of many rational numbers, rounded correctly, whatever their denominators. Host only.

#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/cancellation.h"
#include "exact/overlap/rational_crossing.h"
#include "exact/overlap/scaled.h"

namespace crumple {

class RationalSum {
   public:
    void add(const Rational& term);
    /// Adds numerator / denominator · 2^exponent; the denominator is positive.
    void add(const Integer& numerator, const Integer& denominator, int exponent);
    void add(const RationalSum& other);
    /// Adds `times` · factor · sum.
    void add_product(const RationalSum& sum, double factor, int times = 1);

    /// The sum divided by a whole number, rounded to nearest, ties to even. All terms are first rounded far below the
    /// sum, which decides unless the sum is 0 or a tie; then they are added up. Terms of one denominator are one term
    /// already. Cost: some microseconds a denominator, and for ties what the products of all denominators take.
    RoundedSum rounded_quotient(int divisor, Cancellation& cancellation) const;
    Rational total(Cancellation& cancellation) const;

   private:
    /// numerator · 2^exponent
    struct Part {
        mp::cpp_int numerator = 0;
        int exponent = 0;

        void add(const mp::cpp_int& other, int other_exponent);
    };

    std::unordered_map<mp::cpp_int, Part> over_;  ///< what stands over each odd denominator
};

/// Sum of square roots of rational numbers, each times a sum that is not negative.
class RootSum {
   public:
    /// The sum that is multiplied by the root of a positive number.
    RationalSum& times_root_of(const Rational& square) { return of_[square]; }
    void add(const RootSum& other);

    /// The sum divided by a whole number, rounded to nearest, ties to even. Roots that are rational are added up
    /// exactly. If others remain, the sum is irrational, for nothing cancels: enough bits decide how it is rounded.
    RoundedSum rounded_quotient(int divisor, Cancellation& cancellation) const;

   private:
    std::map<Rational, RationalSum> of_;
};

}  // namespace crumple
