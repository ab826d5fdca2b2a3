#pragma once

// Worlds of named bodies in which nothing can be near, at the start or all along a step: told by boxes over the trees
// of their shapes, without a look at features.

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

    /// Reads a world: features of two bodies are near at a distance of at most `reach`. `step`: at some time between
    /// start and end, else at the start. Only shapes are known that have names and triangles alone.
    void read(const WorldOutline& outline, const BodyRules& rules, bool step, double reach);
    /// Forgets the world: nothing is clear.
    void forget() { known_ = false; }

    /// True if nothing is near in a pass: world by world, then what is in all worlds.
    bool clear(std::int32_t pass) const;

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
    bool may_be_near(const Posed& a, std::int32_t node_a, const Posed& b, std::int32_t node_b) const;

    ShapeTrees& trees_;
    const WorldOutline* outline_ = nullptr;
    const BodyRules* rules_ = nullptr;
    bool known_ = false;
    double half_ = 0;  ///< of the reach, rounded up
    std::vector<Posed> bodies_;
    NearBodies near_;
};

}  // namespace crumple
