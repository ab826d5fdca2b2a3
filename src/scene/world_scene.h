#pragma once

// Scene of posed triangles, made from the bodies of one world: from all of their triangles, or only from those that may
// meet. Any backend can search it. For backends that search several worlds at once (BackendBase::worlds_at_once), one
// scene can hold several worlds side by side (PreparedScene::worlds).
//
// Worlds are added one after the other, with their bodies in ascending order, and the triangles of each body in
// ascending order, so that the scene's pairs are in the order of the result. Triangles of one body and one group form a
// class, and the scene's groups are indices of classes (BodyFilter::classes).

#include <cstdint>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "scene/body_filter.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"
#include "scene/shape_tree.h"
#include "scene/world_outline.h"

namespace crumple {

class WorldScene {
   public:
    explicit WorldScene(MemoryMeter* meter);

    /// Starts a new scene, whose classes are stored in `rules`. `float32`: true if all shapes are float32. `moving`:
    /// true if the scene has end positions, too.
    void begin(bool float32, BodyFilter& rules, bool moving = false);

    /// Adds body b: all of its triangles or, if `near` is not empty, only those whose box at the start overlaps a box
    /// in `near`. `everywhere`: see BodyClass. Throws Error that names the body, and the vertex or triangle.
    void add(const WorldOutline& outline, std::int32_t b, bool everywhere, ParallelFor& workers,
             std::span<const Bounds> near = {});
    /// Adds only elements in the given groups of body b's tree: all of them or, if `near` is not empty, only triangles
    /// whose box at the start overlaps a box in `near`. Not for pairs within the body: each group has its own vertices,
    /// so adjacent elements of two groups do not share any.
    void add(const WorldOutline& outline, std::int32_t b, bool everywhere, const ShapeTree& tree,
             std::span<const std::int32_t> groups, std::span<const Bounds> near);

    /// Ends a world: bodies added from here on belong to the next one.
    void end_world() { first_of_world_.push_back(triangles()); }

    /// Returns the scene, valid until the next begin(). `weld`: vertices at equal positions count as one.
    PreparedScene scene(const WorldOutline& outline, bool weld, ParallelFor& workers);

    /// Returns the scene with the proxy triangles of `features`: degenerate triangles that own the edges and points
    /// which no triangle owns (scene_features.h). Each is in the class of a triangle that names its feature, else in a
    /// further class of its body. Valid until the next begin().
    PreparedScene with_proxies(const WorldOutline& outline, const SceneFeatures& features, const PreparedScene& scene);

    std::int64_t first_of_world(std::size_t w) const { return first_of_world_[w]; }
    std::int64_t triangles() const { return static_cast<std::int64_t>(triangle_.size()); }
    std::int32_t body(std::int32_t t) const { return (*classes_)[groups_[t]].body; }
    std::int32_t triangle(std::int32_t t) const { return triangle_[t]; }  ///< index within its body

    std::int64_t vertices() const {
        return static_cast<std::int64_t>(float32_ ? start_.f.size() : start_.d.size()) / 3;
    }

    /// Returns the body of a vertex, as an index among the added bodies (see added_body()).
    std::size_t added_of(std::int32_t vertex) const;
    std::size_t added() const { return added_.size(); }
    std::int32_t added_body(std::size_t i) const { return added_[i].body; }
    std::int64_t first_vertex(std::size_t i) const { return added_[i].first_vertex; }
    std::int64_t end_vertex(std::size_t i) const { return i + 1 < added() ? first_vertex(i + 1) : vertices(); }

    /// True if only groups of the i-th added body's tree were added. Then edges() and points() return those of its
    /// codimensional edges and points that are in the groups, with vertices of the scene.
    bool has_only_groups(std::size_t i) const { return added_[i].only_groups; }
    std::span<const Edge> edges(std::size_t i) const {
        return edges_.span().subspan(added_[i].first_edge, added_[i].end_edge - added_[i].first_edge);
    }
    std::span<const std::int32_t> points(std::size_t i) const {
        return points_.span().subspan(added_[i].first_point, added_[i].end_point - added_[i].first_point);
    }

   private:
    struct Added {
        std::int32_t body;
        std::int64_t first_vertex;
        bool everywhere, only_groups = false;
        std::size_t first_edge = 0, end_edge = 0, first_point = 0, end_point = 0;
    };
    struct Row {
        std::int32_t element, corner[3];
    };

    /// Vertex positions at one time.
    struct Coordinates {
        explicit Coordinates(MemoryMeter* m) : f(m), d(m) {}
        Array<float> f;
        Array<double> d;
    };
    /// Writes the positions of `count` vertices; position_of(i) returns that of vertex `first` + i.
    template <class PositionOf>
    void put(Coordinates& coordinates, std::int64_t first, std::int64_t count, PositionOf position_of);
    Vec3d at(std::int64_t vertex) const {
        const auto row = [&](const auto& c) { return Vec3d{c[3 * vertex], c[3 * vertex + 1], c[3 * vertex + 2]}; };
        return float32_ ? row(start_.f) : row(start_.d);
    }
    void mark_sides(std::int64_t first, std::span<const Bounds> near);
    bool is_near(const Row& row, std::int64_t first, std::span<const Bounds> near) const;
    bool is_near(const Row& row, std::span<const Bounds> near) const;
    VertexView view(const Coordinates& coordinates) const;
    void grow_vertices(std::int64_t more);
    void begin_body(std::int32_t b, bool everywhere);
    void add_triangle(const WorldOutline& outline, std::int32_t b, bool everywhere, const Row& row);

    bool float32_ = true, moving_ = false;
    Array<BodyClass>* classes_ = nullptr;
    BodyFilter* rules_ = nullptr;
    Coordinates start_, end_;
    Array<std::int32_t> corner_, groups_, triangle_;
    Array<std::int32_t> lone_groups_;  ///< PreparedScene::lone_groups, if there are proxy triangles
    Array<std::int64_t> first_of_world_;
    Array<Added> added_;
    Array<Edge> edges_;           ///< of bodies of which only groups were added
    Array<std::int32_t> points_;  ///< likewise
    Array<Row> row_;              ///< scratch
    Array<std::uint64_t> sides_;  ///< scratch: see mark_sides()
    SceneBuffers buffers_;
};

/// Throws Error (not_finite) that names the first vertex of the body that is not finite, or that its pose moves to
/// infinity. Checks all vertices at the start, then those at the end.
[[noreturn]] void fail_body_not_finite(const WorldOutline& outline, std::int32_t b);

}  // namespace crumple
