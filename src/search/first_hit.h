#pragma once

// Decides if two bodies meet at all, if the shapes of both have trees (scene/shape_tree.h): walks both trees, decides
// overlapping groups triangle by triangle, and ends at the first pair of triangles that collides. Builds and sorts no
// lists.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/intersections.h"
#include "scene/body_filter.h"
#include "scene/shape_tree.h"
#include "scene/world_outline.h"

namespace crumple {

/// Group of triangles of a tree under a body's pose: its vertices and their box.
class PosedGroup {
   public:
    struct Boxed {
        Bounds box;
        int triangle;
    };
    using Buffers = std::array<Boxed, ShapeTree::most_elements>;

    void pose(const ShapeTree& tree, const Placement& place, std::int32_t group);
    Bounds box(int triangle) const;
    /// Returns the triangles of the group whose boxes overlap `other`, stored in `room`.
    std::span<const Boxed> boxes_overlapping(const Bounds& other, Buffers& room) const;

    std::int32_t index = -1;  ///< index of the posed group; -1 before the first pose()
    const ShapeTree::Group* group = nullptr;
    Bounds all;
    alignas(64) ShapeTree::Posed coordinate;

    Vec3d vertex(std::size_t v) const { return {coordinate[0][v], coordinate[1][v], coordinate[2][v]}; }
};

/// True if bodies a and b have a pair of triangles that collides and that the filter of groups selects. The caller must
/// have checked the filter of bodies. Adds the number of pairs of triangles that it has decided to `decided`: those
/// that the filter selects and whose boxes overlap. Thread-safe: accesses its arguments only.
bool bodies_meet(const WorldOutline& outline, const IntersectionQuery& query, const BodyFilter& rules, std::int32_t a,
                 const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, std::int64_t& decided);

}  // namespace crumple
