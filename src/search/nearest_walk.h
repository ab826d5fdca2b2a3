#pragma once

// How far two bodies are apart: a walk over the trees of both that leaves out what is farther apart than what was found
// so far, and lists the pairs of triangles that may be the closest ones; these are decided in the end.

#include <array>
#include <cstdint>
#include <optional>

#include "base/cancellation.h"
#include "exact/distance/decide_nearest.h"
#include "results/nearest_output.h"
#include "scene/body_rules.h"
#include "scene/box_distance.h"
#include "scene/shape_tree.h"
#include "scene/world_outline.h"

namespace crumple {

/// A group of a tree under a pose: its vertices, and how far it and its triangles reach.
struct PosedLeaf {
    const ShapeTree::Group* group = nullptr;
    BoxDistance::Reach all;
    std::array<BoxDistance::Reach, ShapeTree::most_triangles> reach;
    alignas(64) ShapeTree::Posed coordinate;

    TrianglePoints triangle(std::size_t k) const;
};

/// How much was done.
struct NearestCounts {
    std::int64_t tests = 0;     ///< pairs of triangles that were looked at in float64
    std::int64_t exact = 0;     ///< of these, decided by what decides about intersections
    std::int64_t rational = 0;  ///< in rational arithmetic
};

/// Walks of one thread, one after the other; what they need room for is kept.
class NearestWalk {
   public:
    NearestWalk(const WorldOutline& outline, const BodyRules& rules, Cancellation& cancellation, MemoryMeter* meter)
        : outline_(outline), rules_(rules), cancellation_(cancellation), a_(meter), b_(meter), candidates_(meter) {}

    /// Whether the bodies have a wanted pair of triangles at most `radius` apart; then it is told in `row`.
    bool operator()(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, double radius,
                    NearestRow& row);

    const NearestCounts& counts() const { return counts_; }
    void clear_counts() { counts_ = {}; }

   private:
    /// Nodes meet the same groups again and again. So many fit a core's own memory.
    static constexpr std::size_t leaves_kept = 64;

    struct At {
        std::int32_t node;
        BoxDistance::Reach reach;
    };
    /// One of the bodies.
    struct Side {
        explicit Side(MemoryMeter* meter);
        void forget();

        std::int32_t body = 0;
        const ShapeTree* tree = nullptr;
        Placement place;
        float unit = 1;  ///< of the tree's boxes
        const BoxDistance::Side* boxes = nullptr;
        Array<PosedLeaf> leaves;                        ///< by group, as far as there is room
        std::array<std::int32_t, leaves_kept> group{};  ///< what is in `leaves`; -1: nothing
    };

    void begin(Side& side, std::int32_t body, const ShapeTree& tree);
    void aim(const Vec3d& known);
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
    const BodyRules& rules_;
    Cancellation& cancellation_;
    NearestCounts counts_;
    std::int64_t visits_ = 0;

    // Of the bodies that are walked:
    Side a_, b_;
    std::optional<BoxDistance> boxes_;
    double upper_ = 0;  ///< what is farther apart is of no interest
    float limit_ = 0;   ///< the same as BoxDistance has it
    bool found_ = false, touching_ = false;
    NearestCandidate closest_{};          ///< which gave `upper_`, or that touches
    Vec3d direction_;                     ///< in which that is closest, 0 if there is none
    Array<NearestCandidate> candidates_;  ///< all that may be closest
    std::size_t few_ = 0;                 ///< candidates that are not worth a look whether they are near enough
};

}  // namespace crumple
