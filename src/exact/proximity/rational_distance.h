#pragma once

// The distance between two features at rest, in exact arithmetic for every finite float64 coordinate: the yardstick for
// everything faster, and what that falls back on. The derivation is docs/nearness_algebra.md. Host only.

#include "exact/integer.h"
#include "exact/proximity/resting_features.h"

namespace crumple {

/// numerator / denominator; the latter is positive.
struct Quotient {
    Integer numerator = 0, denominator = 1;
};

/// Cost: some microseconds for ordinary coordinates, and for each question that is asked of it less than that.
class RationalDistance {
   public:
    explicit RationalDistance(const Features& features);

    /// The features have a point in common.
    bool touching() const { return squared_.numerator == 0; }
    bool within(const Reach& reach) const;
    /// The squared distance, rounded to the nearest float64, ties to even; +inf beyond the largest.
    double squared() const;
    /// The distance, rounded down: the largest float64 that is not above it.
    double rounded_down() const;
    ClosestPoints closest() const;

    /// The squared distance in units of 2^(2 exponent()).
    const Quotient& quotient() const { return squared_; }
    int exponent() const { return exponent_; }
    /// The parameters of ClosestPoints, before they are rounded.
    const std::array<Quotient, 2>& at() const { return at_; }

   private:
    Quotient squared_;            ///< in units of 2^(2 exponent_)
    std::array<Quotient, 2> at_;  ///< see ClosestPoints
    std::uint8_t type_ = 0;
    int exponent_ = 0;
};

}  // namespace crumple
