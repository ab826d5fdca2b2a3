#pragma once

// Distance of two static features, in exact arithmetic for every finite float64 coordinate: the reference for all
// faster versions, and their fallback. The derivation is in docs/nearness_algebra.md. Host only.

#include "exact/integer.h"
#include "exact/proximity/static_features.h"

namespace crumple {

/// numerator / denominator; the latter is positive.
struct Quotient {
    Integer numerator = 0, denominator = 1;
};

/// Exact distance of one pair of features. Cost: some microseconds for ordinary coordinates in the constructor, and
/// less for each member function.
class RationalDistance {
   public:
    explicit RationalDistance(const Features& features);

    /// True if the features have a point in common.
    bool touching() const { return squared_.numerator == 0; }
    bool within(const DistanceLimit& reach) const;
    /// Returns the squared distance, rounded to the nearest float64, ties to even; +inf beyond the largest.
    double squared() const;
    /// Returns the largest float64 not above the distance.
    double rounded_down() const;
    /// Returns the distance, rounded to the nearest float64, ties to even; +inf beyond the largest.
    double rounded() const;
    ClosestPoints closest() const;

    /// Returns the squared distance in units of 2^(2 exponent()).
    const Quotient& quotient() const { return squared_; }
    int exponent() const { return exponent_; }
    /// Returns the parameters of ClosestPoints before rounding.
    const std::array<Quotient, 2>& at() const { return at_; }

   private:
    Quotient squared_;            ///< in units of 2^(2 exponent_)
    std::array<Quotient, 2> at_;  ///< see ClosestPoints
    std::uint8_t type_ = 0;
    int exponent_ = 0;
};

}  // namespace crumple
