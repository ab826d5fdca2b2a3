#pragma once

// Finds worlds that are clear: in which no pair of bodies that the filter selects can come near each other, at the
// start or during the whole step. For any other world, lists the groups of triangles that may come near those of
// another body. A group is a leaf of a shape's tree (scene/shape_tree.h), so all shapes must have names. Compares boxes
// of the trees only, no features.

#include <compare>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "scene/body_filter.h"
#include "scene/near_bodies.h"
#include "scene/shape_trees.h"
#include "scene/world_outline.h"

namespace crumple {

class ClearWorlds {
   public:
    ClearWorlds(MemoryMeter& meter, ShapeTrees& trees) : meter_(meter), trees_(trees), near_(&meter) {}

    /// Group of triangles that may be near another body: a leaf of the tree of a body's shape.
    struct Mark {
        std::int32_t body, group;
        friend auto operator<=>(const Mark&, const Mark&) = default;
    };

    /// Reads a world. Features of two bodies are near if their distance is at most `reach`, at some time of the step if
    /// `step`, else at the start. This is the same as forget() if some shape has no name, or has edges, points, end
    /// positions, radii or a rest shape, or if a body's box is not finite.
    void read(const WorldOutline& outline, const BodyFilter& rules, bool step, double reach);
    /// Forgets the world: clear() then returns false and marks nothing.
    void forget() { known_ = false; }

    /// True if no pair that the filter selects can be near in the world with index `pass`. If `pass` is the number of
    /// worlds, the pairs are those among bodies that are in all worlds. If false, marked() has the groups that may be
    /// near, or is empty if all may be.
    bool clear(std::int32_t pass);
    /// Returns the marks of the last clear(), sorted by body and group.
    std::span<const Mark> marked() const { return marks_; }
    const ShapeTree& tree(std::int32_t body) const { return *bodies_[static_cast<std::size_t>(body)].tree; }

    /// Frees all memory.
    void release();

   private:
    /// Body of a named shape: the shape's tree, and the body's placements.
    struct Posed {
        const ShapeTree* tree;
        Placement start, end;
    };
    Bounds bounds(const Posed& body, const CentredBox& box) const;
    bool may_meet(std::int32_t a, std::int32_t b) const;
    void mark(std::int32_t a, std::int32_t node_a, std::int32_t b, std::int32_t node_b);

    MemoryMeter& meter_;
    ShapeTrees& trees_;
    const WorldOutline* outline_ = nullptr;
    const BodyFilter* rules_ = nullptr;
    bool known_ = false;
    double half_ = 0;  ///< half of `reach`, rounded up; all boxes are inflated by it
    std::vector<Posed> bodies_;
    std::vector<Mark> marks_;
    NearBodies near_;
};

}  // namespace crumple
