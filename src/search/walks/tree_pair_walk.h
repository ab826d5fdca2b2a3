#pragma once

// Base of walks through the trees of two bodies' shapes (scene/shape_tree.h) at once. Nodes, groups and elements that
// are certainly farther apart than a limit are pruned, by their intervals along the directions of scene/box_distance.h.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/cancellation.h"
#include "exact/distance/triangle_features.h"
#include "scene/box_distance.h"
#include "scene/shape_tree.h"

namespace crumple {

/// Group of elements of a tree under a body's pose: its vertices, and the intervals of the group and of each element,
/// at the start or during a step, along the directions of BoxDistance.
struct PosedLeaf {
    const ShapeTree::Group* group = nullptr;
    BoxDistance::Intervals all;
    using Reaches = std::array<BoxDistance::Intervals, ShapeTree::most_elements>;
    Reaches reach;
    alignas(64) ShapeTree::Posed coordinate;

    /// Returns the corners of an element, which is a degenerate triangle if it is an edge or a point.
    TrianglePoints triangle(std::size_t k) const {
        const auto& c = group->corner[k];
        const auto vertex = [&](std::size_t v) { return Vec3d{coordinate[0][v], coordinate[1][v], coordinate[2][v]}; };
        return {vertex(c[0]), vertex(c[1]), vertex(c[2])};
    }
};

class TreePairWalk {
   protected:
    TreePairWalk(Cancellation& cancellation, MemoryMeter* meter) : cancellation_(cancellation), a_(meter), b_(meter) {}

    /// Number of posed groups that are cached for each body, because walks visit the same groups repeatedly. This many
    /// fit in a core's cache.
    static constexpr std::size_t cached_leaves = 64;

    /// Node of a tree, and the intervals of its box along all directions.
    struct At {
        std::int32_t node;
        BoxDistance::Intervals reach;
    };

    /// State of one of the two bodies.
    struct Side {
        explicit Side(MemoryMeter* meter) : leaves(meter) {}
        void begin(const ShapeTree& of, const BoxDistance::Step& placed) {
            tree = &of;
            step = placed;
            unit = static_cast<float>(of.frame().unit);
        }
        void forget() { group.fill(-1); }

        const ShapeTree* tree = nullptr;
        BoxDistance::Step step;
        float unit = 1;  ///< unit of length of the tree's boxes (SmallFrame)
        const BoxDistance::Side* boxes = nullptr;
        Array<PosedLeaf> leaves;                          ///< cached groups, direct-mapped by group number
        std::array<std::int32_t, cached_leaves> group{};  ///< the group in each entry of `leaves`; -1: none
    };

    /// Sets the directions along which intervals are compared: for the start of the step, with `known` among them
    /// (box_distance.h). Empties the caches, because new directions invalidate all cached intervals.
    void set_directions(const Vec3d& known, double distance);
    /// The same, for the whole step: all intervals then are those of the step.
    void set_directions_of_step(double distance);
    void set_limit(double distance) { limit_ = boxes_->limit(distance); }

    At at(const Side& side, std::int32_t node) const {
        const SmallBox& box = side.tree->node(node).box;
        return {node, is_step_ ? side.boxes->swept(box) : (*side.boxes)(box)};
    }
    std::array<At, 2> halves(const Side& side, std::int32_t node) const {
        return {at(side, node + 1), at(side, side.tree->node(node).right)};
    }
    bool is_leaf(const Side& side, const At& at) const { return side.tree->node(at.node).group >= 0; }
    bool first_is_split(const At& a, const At& b) const {
        const ShapeTree::Node &node_a = a_.tree->node(a.node), &node_b = b_.tree->node(b.node);
        if (node_a.group >= 0 || node_b.group >= 0) return node_b.group >= 0;
        return a_.unit * node_a.extent() > b_.unit * node_b.extent();
    }

    /// Splits the larger of two nodes, which must not both be leaves. Calls visit(a, b) for each half and the other
    /// node, the closer half first, unless they are farther apart than limit_. Ends and returns true when visit returns
    /// true.
    template <class Visit>
    bool visit_halves(const At& a, const At& b, Visit visit) const;
    /// To be called once for each visit of a pair of groups. Throws Error (cancelled) if a stop is requested.
    void poll() {
        constexpr std::int64_t visits_between_checks = 256;
        if (++visits_ % visits_between_checks == 0) cancellation_.check();
    }
    /// Returns a group, with the vertices under the pose at the start.
    const PosedLeaf& posed(Side& side, std::int32_t group);
    /// Calls test(i, j) for each pair of elements of two groups, unless their intervals are farther apart than limit_.
    template <class Test>
    void for_each_close_pair(const PosedLeaf& a, const PosedLeaf& b, Test test) const;

    Cancellation& cancellation_;
    Side a_, b_;
    std::optional<BoxDistance> boxes_;
    float limit_ = 0;  ///< result of BoxDistance::limit(): pairs with larger gaps are pruned
    bool is_step_ = false;

   private:
    void use_directions(double distance);
    void find_intervals(const Side& side, const ShapeTree::Group& group, const ShapeTree::Posed& coordinate,
                        PosedLeaf::Reaches& reach) const;

    std::int64_t visits_ = 0;
};

template <class Visit>
bool TreePairWalk::visit_halves(const At& a, const At& b, Visit visit) const {
    const bool split_a = first_is_split(a, b);
    const auto half = halves(split_a ? a_ : b_, (split_a ? a : b).node);
    const At& other = split_a ? b : a;
    const float gaps[2] = {gap(half[0].reach, other.reach), gap(half[1].reach, other.reach)};
    const std::size_t first = gaps[1] < gaps[0];
    for (const std::size_t k : {first, 1 - first})
        if (!(gaps[k] > limit_) && (split_a ? visit(half[k], other) : visit(other, half[k]))) return true;
    return false;
}

template <class Test>
void TreePairWalk::for_each_close_pair(const PosedLeaf& a, const PosedLeaf& b, Test test) const {
    if (gap(a.all, b.all) > limit_) return;
    std::array<std::size_t, ShapeTree::most_elements> near_b;
    std::size_t n = 0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(b.group->count); ++j)
        if (!(gap(a.all, b.reach[j]) > limit_)) near_b[n++] = j;
    if (n == 0) return;
    BoxDistance::Intervals all_b = b.reach[near_b[0]];
    for (const std::size_t j : std::span(near_b.data(), n)) all_b.widen(b.reach[j]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.group->count); ++i) {
        if (gap(a.reach[i], all_b) > limit_) continue;
        for (const std::size_t j : std::span(near_b.data(), n))
            if (!(gap(a.reach[i], b.reach[j]) > limit_)) test(i, j);
    }
}

}  // namespace crumple
