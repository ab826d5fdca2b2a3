#pragma once

// Worlds of named bodies in which nothing can be near, at the start or all along a step, and what may be near in
// others: told by boxes over the trees of their shapes, without a look at features.

#include <compare>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "scene/body_rules.h"
#include "scene/near_bodies.h"
#include "scene/shape_trees.h"
#include "scene/world_outline.h"

namespace crumple {

class ClearWorlds {
   public:
    ClearWorlds(MemoryMeter& meter, ShapeTrees& trees) : trees_(trees), near_(&meter) {}

    /// A group of triangles of a body's tree.
    struct Mark {
        std::int32_t body, group;
        friend auto operator<=>(const Mark&, const Mark&) = default;
    };

    /// Reads a world: features of two bodies are near at a distance of at most `reach`. `step`: at some time between
    /// start and end, else at the start. Only shapes are known that have names and triangles alone.
    void read(const WorldOutline& outline, const BodyRules& rules, bool step, double reach);
    /// Forgets the world: nothing is clear, and all may be near.
    void forget() { known_ = false; }

    /// True if nothing is near in a pass: world by world, then what is in all worlds. Else marked() has what may be.
    bool clear(std::int32_t pass);
    /// Marks by body and group; empty where it is not known what may be near.
    std::span<const Mark> marked() const { return marks_; }
    const ShapeTree& tree(std::int32_t body) const { return *bodies_[static_cast<std::size_t>(body)].tree; }

    /// Gives all memory back.
    void release();

   private:
    /// A body of a named shape: its tree, and where that goes.
    struct Posed {
        const ShapeTree* tree;
        Placement start, end;
    };
    Bounds bounds(const Posed& body, const CentredBox& box) const;
    bool may_meet(std::int32_t a, std::int32_t b) const;
    void mark(std::int32_t a, std::int32_t node_a, std::int32_t b, std::int32_t node_b);

    ShapeTrees& trees_;
    const WorldOutline* outline_ = nullptr;
    const BodyRules* rules_ = nullptr;
    bool known_ = false;
    double half_ = 0;  ///< of the reach, rounded up
    std::vector<Posed> bodies_;
    std::vector<Mark> marks_;
    NearBodies near_;
};

}  // namespace crumple
