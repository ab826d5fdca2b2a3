#pragma once

// The distance between two features at rest, exactly: quick_distance.h, and rational arithmetic for what that leaves
// open. Host only.

#include <cstdint>
#include <optional>

#include "exact/proximity/quick_distance.h"
#include "exact/proximity/rational_distance.h"

namespace crumple {

/// How far decisions had to go.
struct DistanceCounts {
    std::int64_t rational = 0;  ///< pairs of features for which some question took rational arithmetic
};

/// What is asked of one pair of features, question by question; what one has found out serves the next.
/// Cost: 20 to 70 ns for `within`, some 100 ns for `squared`, some 200 ns for `closest`; microseconds with rationals.
/// Needs round-to-nearest without flush-to-zero.
class Distance {
   public:
    /// Counts are kept by reference.
    Distance(const Features& features, DistanceCounts& counts)
        : features_(features), quick_(features), counts_(counts) {}

    /// Whether it is at most the reach, or below it.
    bool within(const Reach& reach);
    /// Whether it is 0.
    bool touching();
    /// Its square, rounded to the nearest float64, ties to even; +inf beyond the largest.
    double squared();
    /// The largest float64 that is not above it.
    double rounded_down();
    ClosestPoints closest();

    /// Where the features are about closest.
    const detail::Guess& guess() const { return quick_.guess(); }

   private:
    detail::Enclosure& enclosure();
    const RationalDistance& exact();

    Features features_;
    QuickDistance quick_;
    std::optional<detail::Enclosure> enclosure_;
    std::optional<RationalDistance> exact_;
    DistanceCounts& counts_;
};

}  // namespace crumple
