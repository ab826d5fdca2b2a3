#pragma once

// Finds worlds of named bodies in which nothing can be near, at the start or during the whole step, and in other worlds
// the groups of triangles that may be near. Compares boxes of the shapes' trees only, no features.

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
    ClearWorlds(MemoryMeter& meter, ShapeTrees& trees) : trees_(trees), near_(&meter) {}

    /// Group of triangles of a body's tree.
    struct Mark {
        std::int32_t body, group;
        friend auto operator<=>(const Mark&, const Mark&) = default;
    };

    /// Reads a world in which features of two bodies are near if their distance is at most `reach`. `step`: at some
    /// time between start and end, else at the start. Has no effect unless all shapes have names and consist of
    /// triangles only.
    void read(const WorldOutline& outline, const BodyFilter& rules, bool step, double reach);
    /// Forgets the world: clear() then returns false, and marked() is empty.
    void forget() { known_ = false; }

    /// True if nothing can be near in world `pass`; worlds() stands for pairs among bodies that are in all worlds. If
    /// false, marked() has the groups that may be near.
    bool clear(std::int32_t pass);
    /// Returns the marks of the last clear() by body and group; empty if unknown.
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

    ShapeTrees& trees_;
    const WorldOutline* outline_ = nullptr;
    const BodyFilter* rules_ = nullptr;
    bool known_ = false;
    double half_ = 0;  ///< half of `reach`, rounded up
    std::vector<Posed> bodies_;
    std::vector<Mark> marks_;
    NearBodies near_;
};

}  // namespace crumple
