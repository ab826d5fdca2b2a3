#pragma once

// How far apart moving features are to stay.

namespace crumple {

/// What is asked for: the first time at which the distance of two features is at most the larger of both.
struct Separation {
    double distance = 0;  ///< Euclidean, finite and not negative
    double share = 0;     ///< of the distance that the two have at the start, in [0, 1)
    /// Features that start within it touch only when they come closer than they start: ImpactQuery::approaching_only.
    bool approaching_only = false;

    bool contact_only() const { return distance == 0 && share == 0; }
};

}  // namespace crumple
