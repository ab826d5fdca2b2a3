#pragma once

// Finds the distance of two bodies. Walks the trees of their shapes, prunes nodes and triangles that are farther apart
// than the closest pair so far, and collects the pairs of triangles that may be the closest ones; these are decided
// exactly at the end.

#include <cstdint>
#include <optional>

#include "base/cancellation.h"
#include "exact/distance/decide_nearest.h"
#include "results/nearest_output.h"
#include "scene/body_filter.h"
#include "scene/world_outline.h"
#include "search/walks/tree_pair_walk.h"

namespace crumple {

/// Counts of tests of all walks since clear_counts().
struct NearestCounts {
    std::int64_t tests = 0;     ///< pairs of triangles that neither intervals nor groups have excluded
    std::int64_t exact = 0;     ///< pairs of triangles for which it was decided exactly whether they intersect
    std::int64_t rational = 0;  ///< number of decisions that needed rational arithmetic
};

/// Runs one walk after another and reuses its memory. Used by one thread at a time.
class NearestWalk : private TreePairWalk {
   public:
    NearestWalk(const WorldOutline& outline, const BodyFilter& rules, Cancellation& cancellation, MemoryMeter* meter)
        : TreePairWalk(cancellation, meter), outline_(outline), rules_(rules), candidates_(meter) {}

    /// True if the bodies have a pair of triangles that the filter selects, at most `radius` apart; `row` then has the
    /// closest one.
    bool operator()(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, double radius,
                    NearestRow& row);

    /// Bounds the distance of the bodies from above, by a single descent in both trees. Returns nothing if they are
    /// certainly farther apart than `radius`. Else returns an upper bound on the distance, which is valid if the
    /// distance is at most `radius`. The bound is infinite if the descent finds no pair of triangles that the filter
    /// selects and that may be within `radius`.
    std::optional<double> upper_bound(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b,
                                      double radius);

    const NearestCounts& counts() const { return counts_; }
    void clear_counts() { counts_ = {}; }

   private:
    bool begin(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, double radius);
    void descend(At a, At b);
    void walk(const At& a, const At& b);
    bool comes_later(const At& a, const At& b) const;
    void visit(std::int32_t group_a, std::int32_t group_b);
    void test(const PosedLeaf& a, std::size_t i, const PosedLeaf& b, std::size_t j);
    void test_contact(const Pair& pair, const TrianglePoints& a, const TrianglePoints& b);
    bool wanted(const Pair& pair) const;
    void set_upper(double upper);
    void drop_far_candidates();

    const WorldOutline& outline_;
    const BodyFilter& rules_;
    NearestCounts counts_;

    // State of the current walk:
    std::int32_t body_a_ = 0, body_b_ = 0;
    /// Largest distance that is not pruned: at first slightly more than the radius, then the lowest upper bound found
    /// on the distance. limit_ follows it.
    double upper_ = 0;
    bool found_ = false, touching_ = false;
    /// Pair that gave `upper_`, or the first candidate if none did; if pairs touch, the first of them found so far in
    /// the order of the result.
    NearestCandidate closest_{};
    Vec3d direction_;  ///< direction between the closest points of the last `closest_` that did not touch, else 0
    Array<NearestCandidate> candidates_;  ///< all pairs of triangles that may be the closest, unless a pair touches
    /// Candidates that have become too far are dropped when there are more than this many.
    std::size_t drop_threshold_ = 0;
};

}  // namespace crumple
