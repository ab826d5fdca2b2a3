#pragma once

// Minimum distance of a query about motion.

namespace crumple {

/// Requested minimum distance, the larger of `distance` and a share of the distance at the start. The result is the
/// first time at which the distance of two features is at most this; see `approaching_only` for features that start
/// within it.
struct MinDistance {
    double distance = 0;  ///< Euclidean, finite and not negative
    double share = 0;     ///< share of the distance at the start, in [0, 1)
    /// True if features that start within the minimum distance only count once they come closer than at the start
    /// (ImpactQuery::approaching_only).
    bool approaching_only = false;

    bool contact_only() const { return distance == 0 && share == 0; }
};

}  // namespace crumple
