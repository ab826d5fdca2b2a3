#pragma once

// Decides if two bodies whose shapes have trees meet at all: walks both trees, decides overlapping groups triangle by
// triangle, and ends at the first pair that collides. Builds and sorts no lists.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/intersections.h"
#include "scene/body_filter.h"
#include "scene/shape_tree.h"
#include "scene/world_outline.h"

namespace crumple {

/// Posed group of a tree: its vertices and their box.
class PosedGroup {
   public:
    struct Boxed {
        Bounds box;
        int triangle;
    };
    using Buffers = std::array<Boxed, ShapeTree::most_triangles>;

    void pose(const ShapeTree& tree, const Placement& place, std::int32_t group);
    Bounds box(int triangle) const;
    /// Lists the triangles whose boxes overlap `other`.
    std::span<const Boxed> boxes_within(const Bounds& other, Buffers& room) const;

    std::int32_t index = -1;  ///< index of the group, -1: none yet
    const ShapeTree::Group* group = nullptr;
    Bounds all;
    alignas(64) ShapeTree::Posed coordinate;

    Vec3d vertex(std::size_t v) const { return {coordinate[0][v], coordinate[1][v], coordinate[2][v]}; }
};

/// Thread-safe: accesses its arguments only. Adds the number of triangle pairs with overlapping boxes to `decided`.
bool bodies_meet(const WorldOutline& outline, const IntersectionQuery& query, const BodyFilter& rules, std::int32_t a,
                 const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, std::int64_t& decided);

}  // namespace crumple
