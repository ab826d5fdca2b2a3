#pragma once

// Duplicates of triangles with a repeated vertex: faces such as (0, 0, 0) that pad an array, and remains of a mesh
// whose vertices were merged.
//
// Two triangles with the same vertices, fewer than three distinct ones, do not collide (docs/contract.md), however many
// lie at one place. Whether one of them collides with another triangle depends only on its vertices and its group. So
// one triangle of each class of duplicates is searched, and the pairs in which it is found are repeated for the others.
// Triangles of a class have the same corners in the same order. Because of rounding, balls and memberships in parts
// depend on the order, so these are equal within a class, too. At most six classes have the same two vertices, as there
// are six orders.
//
// Layout: next[t] is the class's next triangle after t, by ascending id, or -1. `next` is empty if no class has two
// members.

#include <algorithm>
#include <cstdint>

#include "base/cancellation.h"
#include "crumple/array.h"
#include "crumple/intersections.h"
#include "geometry/position_hash.h"
#include "partition/levels.h"
#include "scene/prepared_scene.h"
#include "scene/scene_filter.h"

namespace crumple::cpu {

class Copies {
   public:
    explicit Copies(MemoryMeter* meter) : next_(meter), table_(meter) {}

    /// Finds the classes among the triangles t with included[t], or among all if `included` is null. Triangles of a
    /// class also have equal masks in the levels above the scene. Costs two passes over the corners, so call it only if
    /// some triangle has a repeated vertex; else call clear().
    void find(const PreparedScene& scene, const SceneFilter& rule, const Levels& levels, const std::uint8_t* included);

    void clear() { next_.clear(); }
    bool empty() const { return next_.empty(); }

    /// Excludes all triangles but the first of each class. An empty `included` means that all are included.
    void leave_out(Array<std::uint8_t>& included) const;

    /// Returns how many pairs a pair of two classes' first triangles stands for, itself included.
    std::int64_t count(Pair pair) const { return empty() ? 1 : size(pair.a) * size(pair.b); }

    /// Calls visit for each pair that `pair` stands for, itself included; each with the lower id first.
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

    /// Replaces each pair by all pairs that it stands for, in any order.
    void expand(Array<Pair>& pairs, Cancellation& cancellation) const;

   private:
    std::int64_t size(std::int32_t first) const {
        std::int64_t members = 0;
        for (std::int32_t t = first; t >= 0; t = next_[t]) ++members;
        return members;
    }

    Array<std::int32_t> next_;
    Array<std::int32_t> table_;  ///< scratch of find(): a hash table of the latest triangle of each class
    SeededHash hash_;
};

}  // namespace crumple::cpu
