#pragma once

// Groups of some sixteen triangles of one shape, and a binary tree of boxes over them, in the shape's own frame.
//
// [MZ] builds no hierarchy, because one has to be built or refitted whenever triangles move. A named shape never does:
// its tree is built once and serves every body of that shape under every pose. It only leaves triangles out: which
// groups of two bodies may meet. What becomes of those is decided as ever.
//
// Built from the top by halving the centroids' order along the longest axis, so that all groups but one are full.
// Nodes lie in the order of a depth-first walk: the left child follows its parent. Each group has its own vertices, so
// that it can be posed alone.

#include <array>
#include <cstdint>

#include "crumple/array.h"
#include "model/placement.h"
#include "model/world.h"

namespace crumple {

class ShapeTree {
   public:
    static constexpr int most_triangles = 16;

    struct Node {
        Bounds box;
        std::int32_t right = 0;   ///< the right child; the left one is the next node
        std::int32_t group = -1;  ///< not negative: a leaf
    };

    struct Group {
        std::int32_t count = 0;         ///< triangles
        std::int64_t first_vertex = 0;  ///< in the tree's vertices
        std::int32_t vertices = 0;
        std::array<std::int32_t, most_triangles> triangle;  ///< of the shape, ascending
        std::array<std::array<std::uint8_t, 3>, most_triangles> corner;
    };

    explicit ShapeTree(MemoryMeter* meter) : node_(meter), group_(meter), vertex_(meter), order_(meter) {}

    /// Reads the shape: coordinates must be finite and indices in range, or Error (without a shape's name) is thrown.
    /// O(m log m).
    void build(const Shape& shape);

    bool empty() const { return group_.empty(); }
    const Node& node(std::int32_t i) const { return node_[i]; }
    const Group& group(std::int32_t g) const { return group_[g]; }
    std::int32_t groups() const { return static_cast<std::int32_t>(group_.size()); }
    const Vec3d* vertices(const Group& group) const { return vertex_.data() + group.first_vertex; }
    /// Of the whole shape; only if it is not empty.
    const Bounds& box() const { return node_[0].box; }

   private:
    struct Item {
        Vec3d centroid;
        std::int32_t triangle;
    };

    template <class Corners>
    std::int32_t add_node(const Shape& shape, Item* begin, Item* end, Corners corners);
    template <class Corners>
    Bounds add_group(const Shape& shape, Item* begin, Item* end, Corners corners);

    Array<Node> node_;
    Array<Group> group_;
    Array<Vec3d> vertex_;
    Array<Item> order_;  ///< scratch
};

/// Walks both trees, and calls visit(group of a, group of b) for each pair of groups whose posed boxes overlap; ends
/// when that returns false, and returns false then.
template <class Visit>
bool for_each_overlap(const ShapeTree& a, const Placement& pose_a, const ShapeTree& b, const Placement& pose_b,
                      Visit visit);

/// The same of one tree's groups and a box.
template <class Visit>
void for_each_overlap(const ShapeTree& tree, const Placement& pose, const Bounds& box, Visit visit);

namespace detail {

inline double extent(const Bounds& box) { return largest(box.high - box.low); }

template <class Visit>
struct PairWalk {
    const ShapeTree &a, &b;
    const Placement &pose_a, &pose_b;
    Visit& visit;

    bool operator()(std::int32_t i, const Bounds& box_a, std::int32_t j, const Bounds& box_b) {
        if (!overlap(box_a, box_b)) return true;
        const ShapeTree::Node &node_a = a.node(i), &node_b = b.node(j);
        const bool leaf_a = node_a.group >= 0, leaf_b = node_b.group >= 0;
        if (leaf_a && leaf_b) return visit(node_a.group, node_b.group);
        if (leaf_b || (!leaf_a && extent(box_a) > extent(box_b)))
            return (*this)(i + 1, pose_a(a.node(i + 1).box), j, box_b) &&
                   (*this)(node_a.right, pose_a(a.node(node_a.right).box), j, box_b);
        return (*this)(i, box_a, j + 1, pose_b(b.node(j + 1).box)) &&
               (*this)(i, box_a, node_b.right, pose_b(b.node(node_b.right).box));
    }
};

}  // namespace detail

template <class Visit>
bool for_each_overlap(const ShapeTree& a, const Placement& pose_a, const ShapeTree& b, const Placement& pose_b,
                      Visit visit) {
    if (a.empty() || b.empty()) return true;
    return detail::PairWalk<Visit>{a, b, pose_a, pose_b, visit}(0, pose_a(a.box()), 0, pose_b(b.box()));
}

template <class Visit>
void for_each_overlap(const ShapeTree& tree, const Placement& pose, const Bounds& box, Visit visit) {
    if (tree.empty()) return;
    const auto walk = [&](auto& self, std::int32_t i) -> void {
        const ShapeTree::Node& node = tree.node(i);
        if (!overlap(pose(node.box), box)) return;
        if (node.group >= 0) return visit(node.group);
        self(self, i + 1);
        self(self, node.right);
    };
    walk(walk, 0);
}

}  // namespace crumple
