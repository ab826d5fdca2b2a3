#pragma once

// Copies of triangles that name a vertex twice: faces such as (0, 0, 0) that pad an array, and what is left of a mesh
// whose vertices were merged.
//
// Two triangles with the same vertices, fewer than three distinct ones, do not collide (docs/contract.md), however many
// lie at one place; and whether one of them collides with another triangle depends on its vertices and its group alone.
// So one of each class is searched, and the pairs that it is found in are repeated for the others. A class has the same
// corners in the same order, so that also balls and memberships in parts, which rounding makes depend on the order, are
// the same: the vertices of a segment make six classes at most.
//
// Layout: next[t] is the class's next triangle after t, by ascending id, or -1. Empty if no class has two members.

#include <algorithm>
#include <cstdint>

#include "base/cancellation.h"
#include "crumple/array.h"
#include "crumple/intersections.h"
#include "geometry/position_hash.h"
#include "partition/levels.h"
#include "scene/prepared_scene.h"
#include "scene/rules.h"

namespace crumple::cpu {

class Copies {
   public:
    explicit Copies(MemoryMeter* meter) : next_(meter), table_(meter) {}

    /// Finds the classes among the triangles t with included[t], or among all if that is null; members of a class also
    /// have the same masks of the levels above the scene. Two passes over the corners, so call it only if some triangle
    /// names a vertex twice; clear() if not.
    void find(const PreparedScene& scene, const GroupRule& rule, const Levels& levels, const std::uint8_t* included);

    void clear() { next_.clear(); }
    bool empty() const { return next_.empty(); }

    /// Leaves the first of each class included only. Empty: all triangles are.
    void leave_out(Array<std::uint8_t>& included) const;

    /// How many pairs a pair of first ones stands for, itself included.
    std::int64_t count(Pair pair) const { return empty() ? 1 : size(pair.a) * size(pair.b); }

    /// Calls visit for each of them, lower id first.
    template <class Visit>
    void for_each(Pair pair, Cancellation& cancellation, Visit visit) const {
        if (empty()) {
            visit(pair);
            return;
        }
        for (std::int32_t a = pair.a; a >= 0; a = next_[a]) {
            cancellation.check();
            for (std::int32_t b = pair.b; b >= 0; b = next_[b]) visit(Pair{std::min(a, b), std::max(a, b)});
        }
    }

    /// Puts all that they stand for into the place of the pairs.
    void expand(Array<Pair>& pairs, Cancellation& cancellation) const;

   private:
    std::int64_t size(std::int32_t first) const {
        std::int64_t members = 0;
        for (std::int32_t t = first; t >= 0; t = next_[t]) ++members;
        return members;
    }

    Array<std::int32_t> next_;
    Array<std::int32_t> table_;  ///< scratch: the latest triangle of each class
    SeededHash hash_;
};

}  // namespace crumple::cpu
