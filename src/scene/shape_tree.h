#pragma once

// Binary tree of boxes over groups of at most sixteen elements of one shape, in the shape's own frame. The elements are
// the shape's triangles and, in a tree of all elements, its codimensional edges and points, as degenerate triangles.
//
// [MZ] builds no hierarchy, because a hierarchy has to be rebuilt or refitted whenever triangles move. A named shape
// does not change: its tree is built once and serves every body of that shape under every pose. The tree only culls: it
// finds the groups of two bodies that may meet. Their elements are tested elsewhere.
//
// The tree is built top-down: each node is split along its longest axis, at the place that the surface area heuristic
// chooses. Nodes are in depth-first order: the left child follows its parent. Each group has its own copies of its
// vertices, so that it can be posed alone.

#include <array>
#include <cstdint>

#include "crumple/array.h"
#include "scene/placement.h"
#include "scene/separating_boxes.h"
#include "scene/world_outline.h"

namespace crumple {

/// Elements of a tree. `triangles`: the shape's triangles. `all`: the triangles, then the codimensional edges as (a, b,
/// b), then the codimensional points as (v, v, v), numbered in this order.
enum class TreeElements { triangles, all };

class ShapeTree {
   public:
    static constexpr int most_elements = 16;

    struct Node {
        SmallBox box;
        std::int32_t right = 0;   ///< index of the right child; the left child is the next node
        std::int32_t group = -1;  ///< index of a leaf's group; negative for inner nodes

        float extent() const { return max(box.half[0], max(box.half[1], box.half[2])); }
    };

    struct Group {
        std::int32_t count = 0;        ///< number of elements
        std::int64_t first_block = 0;  ///< index of its first block of four vertices, over all groups
        std::int32_t blocks = 0;       ///< number of its blocks; copies of the last vertex fill the last block
        std::int32_t vertices = 0;
        std::array<std::int32_t, most_elements> element;  ///< numbers of the elements, ascending
        std::array<std::array<std::uint8_t, 3>, most_elements> corner;
    };

    /// Coordinates of a group's vertices: all x, all y, all z.
    using Posed = double[3][3 * most_elements];

    explicit ShapeTree(MemoryMeter* meter)
        : node_(meter), first_(meter), group_(meter), vertex_(meter), box_(meter), order_(meter) {}

    /// Builds the tree. Throws Error for coordinates that are not finite, indices out of range, and invalid edges and
    /// points; the message does not name the shape. O(m log m) for m elements.
    void build(const Shape& shape, TreeElements elements = TreeElements::triangles);

    bool empty() const { return group_.empty(); }
    const Node& node(std::int32_t i) const { return node_[i]; }
    /// Returns the lowest element below a node.
    std::int32_t first_element(std::int32_t i) const { return first_[i]; }
    const Group& group(std::int32_t g) const { return group_[g]; }
    std::int32_t groups() const { return static_cast<std::int32_t>(group_.size()); }
    /// Returns the coordinates of a group's vertices along an axis.
    const double* vertices(const Group& group, int axis) const {
        return vertex_.data() + 12 * group.first_block + 4 * axis * group.blocks;
    }
    /// Poses a group's vertices, including the padding of the last block.
    void pose(const Group& group, const Placement& place, Posed& posed) const {
        const double* const given[3] = {vertices(group, 0), vertices(group, 1), vertices(group, 2)};
        double* const to[3] = {posed[0], posed[1], posed[2]};
        place(given, group.blocks, to);
    }
    /// Box of the whole shape; the tree must not be empty.
    const CentredBox& box() const { return frame_.all; }
    const SmallFrame& frame() const { return frame_; }
    /// Returns a node's box in the shape's own coordinates.
    CentredBox box(const Node& node) const { return frame_.box(node.box); }

   private:
    struct Item {
        Vec3d centroid;
        std::int32_t element;
    };

    static Item* split(Item* begin, Item* end);
    template <class Corners>
    Bounds add_node(const Shape& shape, Item* begin, Item* end, Corners corners);
    template <class Corners>
    Bounds add_group(const Shape& shape, Item* begin, Item* end, Corners corners);

    SmallFrame frame_;
    Array<Node> node_;
    Array<std::int32_t> first_;  ///< lowest element of each node
    Array<Group> group_;
    Array<double> vertex_;   ///< coordinates of vertices, group by group: all x, all y, all z of a group
    Array<CentredBox> box_;  ///< scratch: boxes of the nodes
    Array<Item> order_;      ///< scratch
};

/// Walks both trees and calls visit(group of a, group of b) for each pair of groups whose posed boxes are not certainly
/// apart (scene/separating_boxes.h), so at least for all whose boxes overlap. Stops and returns false when visit
/// returns false.
template <class Visit>
bool for_each_overlap(const ShapeTree& a, const Placement& pose_a, const ShapeTree& b, const Placement& pose_b,
                      Visit visit);

/// Calls visit(group) for each group for which the axis-aligned box around its posed box overlaps `box`.
template <class Visit>
void for_each_overlap(const ShapeTree& tree, const Placement& pose, const Bounds& box, Visit visit);

namespace detail {

template <class Visit>
struct PairWalk {
    struct At {
        std::int32_t node;
        SeparatingBoxes::Intervals reach;
    };

    const ShapeTree &a, &b;
    const SeparatingBoxes& separation;
    Visit& visit;
    float extent_a = static_cast<float>(a.frame().unit), extent_b = static_cast<float>(b.frame().unit);

    static At at(const ShapeTree& tree, const SeparatingBoxes::Side& side, std::int32_t node) {
        return {node, side(tree.node(node).box)};
    }
    static std::array<At, 2> children(const ShapeTree& tree, const SeparatingBoxes::Side& side, std::int32_t node) {
        return {at(tree, side, node + 1), at(tree, side, tree.node(node).right)};
    }

    bool begin() {
        const At root_a = at(a, separation.a(), 0), root_b = at(b, separation.b(), 0);
        return gap(root_a.reach, root_b.reach) > 0 || (*this)(root_a, root_b);
    }

    // Visits a pair of nodes whose boxes are not certainly apart. Of the two children, the one that overlaps the other
    // node more comes first, because a hit is most likely there.
    bool operator()(const At& at_a, const At& at_b) {
        const ShapeTree::Node &node_a = a.node(at_a.node), &node_b = b.node(at_b.node);
        const bool leaf_a = node_a.group >= 0, leaf_b = node_b.group >= 0;
        if (leaf_a && leaf_b) return visit(node_a.group, node_b.group);
        const bool split_a = leaf_b || (!leaf_a && extent_a * node_a.extent() > extent_b * node_b.extent());
        const auto half = split_a ? children(a, separation.a(), at_a.node) : children(b, separation.b(), at_b.node);
        const At& other = split_a ? at_b : at_a;
        const float gaps[2] = {gap(half[0].reach, other.reach), gap(half[1].reach, other.reach)};
        const std::size_t first = gaps[1] < gaps[0];
        for (const std::size_t k : {first, 1 - first})
            if (!(gaps[k] > 0) && !(split_a ? (*this)(half[k], other) : (*this)(other, half[k]))) return false;
        return true;
    }
};

}  // namespace detail

template <class Visit>
bool for_each_overlap(const ShapeTree& a, const Placement& pose_a, const ShapeTree& b, const Placement& pose_b,
                      Visit visit) {
    if (a.empty() || b.empty()) return true;
    const SeparatingBoxes separation(pose_a, a.frame(), pose_b, b.frame());
    return detail::PairWalk<Visit>{a, b, separation, visit}.begin();
}

template <class Visit>
void for_each_overlap(const ShapeTree& tree, const Placement& pose, const Bounds& box, Visit visit) {
    if (tree.empty()) return;
    const auto walk = [&](auto& self, std::int32_t i) -> void {
        const ShapeTree::Node& node = tree.node(i);
        if (!overlap(pose(tree.box(node)), box)) return;
        if (node.group >= 0) return visit(node.group);
        self(self, i + 1);
        self(self, node.right);
    };
    walk(walk, 0);
}

}  // namespace crumple
