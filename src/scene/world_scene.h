#pragma once

// Bodies of one world, or what of them may meet, as one scene of posed triangles that any backend can search; for those
// that can, of several worlds side by side (PreparedScene::worlds).
//
// Worlds are added one after the other, bodies of each in ascending order, and triangles of each body in ascending
// order, so that a scene's pairs are in the order of the answer. The scene's groups are classes of BodyRules.

#include <cstdint>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "scene/body_rules.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"
#include "scene/shape_tree.h"
#include "scene/world_outline.h"

namespace crumple {

class WorldScene {
   public:
    explicit WorldScene(MemoryMeter* meter);

    /// Begins anew, with classes in `rules`. `float32`: whether all shapes are. `moving`: whole bodies have ends, too.
    void begin(bool float32, BodyRules& rules, bool moving = false);

    /// All of body b, or, if there are boxes, the triangles whose own overlaps one of `near`. `everywhere`: see
    /// BodyClass. Throws Error with the body, and vertex or triangle.
    void add(const WorldOutline& outline, std::int32_t b, bool everywhere, ParallelFor& workers,
             std::span<const Bounds> near = {});
    /// The triangles of the given groups of its tree whose box overlaps one of `near`, if there are boxes. Pairs within
    /// the body are lost, for each group has vertices of its own.
    void add(const WorldOutline& outline, std::int32_t b, bool everywhere, const ShapeTree& tree,
             std::span<const std::int32_t> groups, std::span<const Bounds> near);

    /// All of a world has been added: what comes next is another's.
    void end_world() { first_of_world_.push_back(triangles()); }

    /// The scene. Valid until begin().
    PreparedScene scene(const WorldOutline& outline, bool weld, ParallelFor& workers);

    /// The scene with the features' carriers, in the classes of their bodies. Valid as scene().
    PreparedScene with_carriers(const WorldOutline& outline, const SceneFeatures& features, const PreparedScene& scene);

    std::int64_t first_of_world(std::size_t w) const { return first_of_world_[w]; }
    std::int64_t triangles() const { return static_cast<std::int64_t>(triangle_.size()); }
    std::int32_t body(std::int32_t t) const { return (*classes_)[groups_[t]].body; }
    std::int32_t triangle(std::int32_t t) const { return triangle_[t]; }  ///< within its body

    std::int64_t vertices() const {
        return static_cast<std::int64_t>(float32_ ? start_.f.size() : start_.d.size()) / 3;
    }

    /// The body that a vertex belongs to, as its position among those that were added.
    std::size_t added_of(std::int32_t vertex) const;
    std::size_t added() const { return added_.size(); }
    std::int32_t added_body(std::size_t i) const { return added_[i].body; }
    std::int64_t first_vertex(std::size_t i) const { return added_[i].first_vertex; }

   private:
    struct Added {
        std::int32_t body;
        std::int64_t first_vertex;
        bool everywhere;
    };
    struct Row {
        std::int32_t triangle, corner[3];
    };

    /// Where vertices are at one moment.
    struct Coordinates {
        explicit Coordinates(MemoryMeter* m) : f(m), d(m) {}
        Array<float> f;
        Array<double> d;
    };
    void put(Coordinates& coordinates, std::int64_t vertex, const Vec3d& p);
    bool is_near(const Row& row, std::span<const Bounds> near) const;
    VertexView view(const Coordinates& coordinates) const;
    void grow_vertices(std::int64_t more);
    void begin_body(std::int32_t b, bool everywhere);
    void add_triangle(const WorldOutline& outline, std::int32_t b, bool everywhere, const Row& row);

    bool float32_ = true, moving_ = false;
    Array<BodyClass>* classes_ = nullptr;
    BodyRules* rules_ = nullptr;
    Coordinates start_, end_;
    Array<std::int32_t> corner_, groups_, triangle_;
    Array<std::int32_t> lone_groups_;  ///< of each vertex, if there are carriers
    Array<std::int64_t> first_of_world_;
    Array<Added> added_;
    Array<Row> row_;  ///< scratch
    SceneBuffers buffers_;
};

/// Throws Error (not_finite) with the first vertex of the body that is not finite, or is posed to infinity; at the
/// start if there is one, else at the end.
[[noreturn]] void fail_body_not_finite(const WorldOutline& outline, std::int32_t b);

}  // namespace crumple
