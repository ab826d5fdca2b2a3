#pragma once

// Exact distance of two static features: by filtered_distance.h, and by rational arithmetic where that filter is not
// certain. Host only.

#include <cstdint>
#include <optional>

#include "exact/proximity/filtered_distance.h"
#include "exact/proximity/rational_distance.h"

namespace crumple {

/// Number of decisions that took rational arithmetic.
struct DistanceCounts {
    std::int64_t rational = 0;  ///< pairs of features for which some query took rational arithmetic
};

/// Queries about one pair of features; intermediate results are cached for later queries.
class Distance {
   public:
    /// Holds a reference to `counts`.
    Distance(const Features& features, DistanceCounts& counts)
        : features_(features), quick_(features), counts_(counts) {}

    /// True if the distance is at most the reach, or below it if reach.strict.
    bool within(const DistanceLimit& reach);
    /// True if the distance is 0.
    bool touching();
    /// Returns the squared distance, rounded to the nearest float64, ties to even; +inf beyond the largest.
    double squared();
    /// Returns the largest float64 not above the distance.
    double rounded_down();
    ClosestPoints closest();

    /// Returns the guess of the closest points.
    const detail::Guess& guess() const { return quick_.guess(); }

   private:
    detail::Enclosure& enclosure();
    const RationalDistance& exact();

    Features features_;
    FilteredDistance quick_;
    std::optional<detail::Enclosure> enclosure_;
    std::optional<RationalDistance> exact_;
    DistanceCounts& counts_;
};

}  // namespace crumple
