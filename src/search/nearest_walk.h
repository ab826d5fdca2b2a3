#pragma once

// Finds the distance of two bodies. Walks the trees of their shapes, prunes nodes and triangles that are farther apart
// than the closest pair so far, and collects the pairs of triangles that may be the closest ones; these are decided
// exactly at the end.

#include <array>
#include <cstdint>
#include <optional>

#include "base/cancellation.h"
#include "exact/distance/decide_nearest.h"
#include "results/nearest_output.h"
#include "scene/body_filter.h"
#include "scene/box_distance.h"
#include "scene/shape_tree.h"
#include "scene/world_outline.h"

namespace crumple {

/// Group of triangles of a tree under a body's pose: its vertices, and the intervals of the group and of each triangle
/// along the directions of BoxDistance.
struct PosedLeaf {
    const ShapeTree::Group* group = nullptr;
    BoxDistance::Intervals all;
    std::array<BoxDistance::Intervals, ShapeTree::most_triangles> reach;
    alignas(64) ShapeTree::Posed coordinate;

    TrianglePoints triangle(std::size_t k) const;
};

/// Counts of tests of all walks since clear_counts().
struct NearestCounts {
    std::int64_t tests = 0;     ///< pairs of triangles that neither intervals nor groups have excluded
    std::int64_t exact = 0;     ///< pairs of triangles for which it was decided exactly whether they intersect
    std::int64_t rational = 0;  ///< number of decisions that needed rational arithmetic
};

/// Runs one walk after another and reuses its memory. Used by one thread at a time.
class NearestWalk {
   public:
    NearestWalk(const WorldOutline& outline, const BodyFilter& rules, Cancellation& cancellation, MemoryMeter* meter)
        : outline_(outline), rules_(rules), cancellation_(cancellation), a_(meter), b_(meter), candidates_(meter) {}

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
    /// Number of posed groups that are cached for each body, because walks visit the same groups repeatedly. This many
    /// fit in a core's cache.
    static constexpr std::size_t cached_leaves = 64;

    struct At {
        std::int32_t node;
        BoxDistance::Intervals reach;
    };
    /// State of one of the two bodies.
    struct Side {
        explicit Side(MemoryMeter* meter);
        void forget();

        std::int32_t body = 0;
        const ShapeTree* tree = nullptr;
        Placement place;
        float unit = 1;  ///< unit of length of the tree's boxes (SmallFrame)
        const BoxDistance::Side* boxes = nullptr;
        Array<PosedLeaf> leaves;                          ///< cached groups, direct-mapped by group number
        std::array<std::int32_t, cached_leaves> group{};  ///< the group in each entry of `leaves`; -1: none
    };

    bool begin(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, double radius);
    void begin(Side& side, std::int32_t body, const ShapeTree& tree);
    void set_directions(const Vec3d& known);
    At at(const Side& side, std::int32_t node) const { return {node, (*side.boxes)(side.tree->node(node).box)}; }
    std::array<At, 2> halves(const Side& side, std::int32_t node) const {
        return {at(side, node + 1), at(side, side.tree->node(node).right)};
    }
    bool is_leaf(const Side& side, const At& at) const { return side.tree->node(at.node).group >= 0; }
    bool first_is_split(const At& a, const At& b) const;
    void descend(At a, At b);
    void walk(const At& a, const At& b);
    bool comes_later(const At& a, const At& b) const;
    const PosedLeaf& posed(Side& side, std::int32_t group);
    void visit(std::int32_t group_a, std::int32_t group_b);
    void test(const PosedLeaf& a, std::size_t i, const PosedLeaf& b, std::size_t j);
    void test_contact(const Pair& pair, const TrianglePoints& a, const TrianglePoints& b);
    bool wanted(const Pair& pair) const;
    void set_upper(double upper);
    void drop_far_candidates();

    const WorldOutline& outline_;
    const BodyFilter& rules_;
    Cancellation& cancellation_;
    NearestCounts counts_;
    std::int64_t visits_ = 0;

    // State of the current walk:
    Side a_, b_;
    std::optional<BoxDistance> boxes_;
    /// Largest distance that is not pruned: at first slightly more than the radius, then the lowest upper bound found
    /// on the distance.
    double upper_ = 0;
    float limit_ = 0;  ///< BoxDistance::limit() of `upper_`: larger gaps are pruned
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
