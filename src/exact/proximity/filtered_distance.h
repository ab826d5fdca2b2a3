#pragma once

// Float64 filter: distance of two static features, in float64 and double words (unevaluated sums of two float64
// numbers), with proven bounds. Results are those of rational_distance.h, to the last bit, or reported as not certain.
// Compiled for host and device; nothing is allocated. Needs round-to-nearest without flush-to-zero. The bounds are
// derived in docs/nearness_algebra.md.

#include "exact/proximity/closest_guess.h"
#include "exact/proximity/enclosure.h"

namespace crumple {

class FilteredDistance {
   public:
    CRUMPLE_HD explicit FilteredDistance(const Features& features)
        : features_(features), differences_(features), guess_(detail::guess_closest(differences_)) {}

    /// Compares in float64 first, then in double words.
    CRUMPLE_HD Proximity compare(const DistanceLimit& reach) const {
        const Proximity known = compare_in_float64(reach);
        return known == Proximity::unknown ? compare_closely(reach) : known;
    }
    CRUMPLE_HD Proximity compare_in_float64(const DistanceLimit& reach) const {
        const double radius = reach.a + reach.b;
        const Vec3d g = differences_.w + guess_.s * differences_.u + guess_.t * differences_.v;
        if (differences_.within(g, radius)) return Proximity::within;
        return differences_.beyond(g, radius) ? Proximity::beyond : Proximity::unknown;
    }

    const detail::Guess& guess() const { return guess_; }

    /// Returns the enclosure for all other queries. Each of them reports if its result is not certain.
    CRUMPLE_HD detail::Enclosure enclosure() const { return {features_, guess_}; }

   private:
    CRUMPLE_HD_COLD Proximity compare_closely(const DistanceLimit& reach) const {
        if (!(differences_.size <= detail::largest_size)) return Proximity::unknown;
        return enclosure().compare(reach);
    }

    Features features_;
    detail::Differences differences_;
    detail::Guess guess_;
};

}  // namespace crumple
