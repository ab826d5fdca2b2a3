#pragma once

// Correctly rounded sums of many rational numbers, whatever their denominators. Host only.

#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/cancellation.h"
#include "exact/overlap/exact_crossing.h"
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

    /// Returns the sum divided by an integer, rounded to nearest, ties to even. First adds terms rounded to 2^-400 of
    /// the largest one. That decides the result unless the sum is almost 0, or almost midway between two float64
    /// numbers (a tie); only then are terms added exactly. Terms whose denominators have the same odd part are merged
    /// when they are added. Cost: some microseconds for each denominator; for ties, additions of numbers as long as the
    /// product of all denominators.
    RoundedSum rounded_quotient(int divisor, Cancellation& cancellation) const;
    Rational total(Cancellation& cancellation) const;

   private:
    /// numerator · 2^exponent
    struct Part {
        mp::cpp_int numerator = 0;
        int exponent = 0;

        void add(const mp::cpp_int& other, int other_exponent);
    };

    std::unordered_map<mp::cpp_int, Part> numerators_;  ///< sums of numerators, by the odd part of their denominators
};

/// Sum of square roots of rational numbers, each times a factor that is not negative and is itself a sum of rational
/// numbers.
class RootSum {
   public:
    /// Returns the factor of the square root of a positive number, so that the caller can add to the factor.
    RationalSum& times_root_of(const Rational& square) { return of_[square]; }
    void add(const RootSum& other);

    /// Returns the sum divided by an integer, rounded to nearest, ties to even. Rational roots are added exactly. If
    /// irrational roots remain, the sum is irrational, because no terms cancel; so enough bits decide how it is
    /// rounded.
    RoundedSum rounded_quotient(int divisor, Cancellation& cancellation) const;

   private:
    std::map<Rational, RationalSum> of_;
};

}  // namespace crumple
