#pragma once

// Intersections of worlds, on any backend: each world's bodies become a scene of posed triangles, from which bodies and
// groups of triangles that cannot meet others are left out.
//
//   shapes with names -----------------------------> trees (scene/shape_tree.h), cached by name
//   other shapes of bodies that are in all worlds -> trees of this call, if there are several worlds
//   bodies  ---------------------------------------> boxes, and pairs of bodies whose boxes overlap
//   if both bodies of a pair have trees, and no pairs of triangles are requested: search/first_hit.h decides the pair
//   else: groups of triangles that may meet, or whole bodies --> WorldScene --> the backend's search of a scene
//
// A scene has one world, or many side by side if the backend supports it (worlds_at_once).
//
// So a body whose box overlaps no other body's box costs only this box. The work for one world does not depend on the
// number of other worlds, nor on the triangles of bodies in all worlds that are far from the world's own bodies.

#include <memory>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/world.h"
#include "results/world_output.h"
#include "scene/body_filter.h"
#include "scene/near_bodies.h"
#include "scene/shape_tree.h"
#include "scene/shape_trees.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {

class WorldSearch {
   public:
    WorldSearch(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& named);

    /// Fills the result or, if `blocks` is not null, delivers it in blocks.
    void find(BackendBase& backend, const World& world, const IntersectionQuery& query, Intersections& result,
              const WorldBlocks* blocks = nullptr);

    /// Frees all memory, except for named shapes.
    void release();

   private:
    struct Mark {
        std::int32_t body, group;
        friend auto operator<=>(const Mark&, const Mark&) = default;
    };

    struct SceneSize {
        std::int64_t triangles = 0, vertices = 0;
    };

    void read_shapes();
    void read_bodies();
    Bounds read_box(std::int32_t b) const;

    // `pass` is the index of a world; the number of worlds stands for the pairs among bodies that are in all worlds.
    std::int32_t passes() const { return outline_.worlds() + 1; }
    std::int32_t begin_of(std::int32_t pass) const { return outline_.first_body(pass); }
    std::int32_t end_of(std::int32_t pass) const;

    const ShapeTree* tree(std::int32_t b) const { return trees_[static_cast<std::size_t>(outline_.body(b).shape)]; }
    bool may_meet(std::int32_t a, std::int32_t b) const;
    bool both_have_trees(std::int32_t a, std::int32_t b) const { return tree(a) && tree(b); }

    void search_directly(BackendBase& backend, Intersections& result);
    bool is_hit(std::int32_t pass, const Intersections& result) const {
        return pass < outline_.worlds() && result.world_hit[pass] != 0;
    }
    void search_scenes(BackendBase& backend, Intersections& result);
    bool is_over(const Intersections& result) const { return query_.output == Output::any && result.any; }
    void collect(std::int32_t pass);
    void mark(std::int32_t a, std::int32_t b);
    template <class Whole, class Some>
    void for_each_collected(Whole whole, Some some);
    SceneSize collected();
    bool joins(const SceneSize& extent) const;
    void gather(BackendBase& backend, std::int32_t pass);
    template <class Work>
    bool fits(Work work) const;
    void search_joined(BackendBase& backend, bool gathered, Intersections& result);
    void search_halves(BackendBase& backend, Intersections& result);
    void search_scene(BackendBase& backend, Intersections& result);
    void add_found(Intersections& result);
    void append(const Intersections& found, Intersections& result);

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    ShapeTrees& named_;

    // State of the current call:
    IntersectionQuery query_;
    const WorldBlocks* blocks_ = nullptr;
    WorldOutline outline_;
    BodyFilter rules_;
    bool float32_ = true;
    bool boxes_ = false;                               ///< true if near_ has the boxes of all bodies
    std::vector<const ShapeTree*> trees_;              ///< tree of each shape; null if it has none
    std::vector<std::unique_ptr<ShapeTree>> of_call_;  ///< trees of the current call, for shapes without a name
    NearBodies near_;
    Array<Mark> marks_;
    Array<BodyPair> near_pairs_;  ///< in the collected world: pairs of bodies that may meet, in both orders
    Array<std::int32_t> groups_, whole_;
    std::vector<Bounds> near_boxes_;
    std::vector<std::int32_t> joined_;  ///< indices of the worlds that are side by side in the scene
    WorldScene scene_;
    Intersections found_;
    Array<std::uint8_t> flags_;  ///< hit flag of each joined world; for Output::any only the first is used

    std::int64_t most_joined_;  ///< maximum number of triangles of several joined worlds; lowered if memory is short
};

}  // namespace crumple
