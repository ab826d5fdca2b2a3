#pragma once

// Validated outline of a world, made without reading coordinates or indices: the number of each body's first triangle
// over all bodies, and the range of bodies of each world.

#include <cstdint>
#include <string>

#include "crumple/array.h"
#include "crumple/query.h"
#include "crumple/world.h"
#include "scene/outline.h"
#include "scene/placement.h"
#include "scene/prepared_scene.h"

namespace crumple {

class WorldOutline {
   public:
    explicit WorldOutline(MemoryMeter* meter) : first_triangle_(meter), first_body_(meter) {}

    /// Validates a world and a pair filter. Throws Error (invalid_argument) that names the body or shape. Keeps a copy
    /// of the views in `world`.
    void read(const World& world, const PairFilter& rules);

    const World& world() const { return world_; }
    std::int32_t bodies() const { return static_cast<std::int32_t>(world_.bodies.size()); }
    const Body& body(std::int32_t b) const { return world_.bodies[static_cast<std::size_t>(b)]; }
    const Shape& shape(std::int32_t b) const { return world_.shapes[static_cast<std::size_t>(body(b).shape)]; }
    Placement placement(std::int32_t b) const {
        return {world_.poses.empty() ? nullptr : &world_.poses[static_cast<std::size_t>(b)],
                shape(b).vertices.type == ScalarType::float32};
    }

    /// Returns the placement at the end of a step: the end pose or, if the world has no end poses, the pose at the
    /// start.
    Placement end_placement(std::int32_t b) const {
        const auto& poses = world_.end_poses.empty() ? world_.poses : world_.end_poses;
        const VertexView& vertices = shape(b).end.data ? shape(b).end : shape(b).vertices;
        return {poses.empty() ? nullptr : &poses[static_cast<std::size_t>(b)], vertices.type == ScalarType::float32};
    }
    /// True if end poses are given, or any shape has end positions.
    bool moving() const;

    /// Worlds are numbered from 0 to worlds() - 1, empty ones included; bodies of world w are [first_body(w),
    /// first_body(w + 1)), those in all worlds [first_body(worlds()), bodies()).
    std::int32_t worlds() const { return static_cast<std::int32_t>(first_body_.size()) - 1; }
    std::int32_t first_body(std::int32_t world) const { return first_body_[world]; }

    /// Number of triangles of all bodies before b.
    std::int64_t first_triangle(std::int32_t b) const { return first_triangle_[b]; }
    std::int64_t triangles() const { return first_triangle_.back(); }

    /// Returns the prefix of errors about a body: "body 3: ".
    static std::string name(std::int32_t b) { return "body " + std::to_string(b) + ": "; }

   private:
    World world_;
    Array<std::int64_t> first_triangle_;
    Array<std::int32_t> first_body_;
};

/// Returns a reader of a shape's vertices in the caller's memory.
inline VertexReader reader_of(const Shape& shape) {
    return {static_cast<const std::byte*>(shape.vertices.data), shape.vertices.row_stride, shape.vertices.column_stride,
            shape.vertices.type == ScalarType::float32};
}

/// Returns a reader of a shape's vertices at the end of a step.
inline VertexReader end_reader_of(const Shape& shape) {
    if (!shape.end.data) return reader_of(shape);
    return {static_cast<const std::byte*>(shape.end.data), shape.end.row_stride, shape.end.column_stride,
            shape.end.type == ScalarType::float32};
}

/// Calls `function(read)`, where read(t, corner) returns a vertex index of triangle t as int64.
template <class Function>
void with_corner_reader(const Shape& shape, Function function) {
    with_index_type(shape.triangles.type, [&](auto type) {
        const TriangleView& view = shape.triangles;
        function([&view](std::int64_t t, int corner) {
            decltype(type) index;
            std::memcpy(&index,
                        static_cast<const std::byte*>(view.data) + t * view.row_stride + corner * view.column_stride,
                        sizeof index);
            return static_cast<std::int64_t>(index);
        });
    });
}

}  // namespace crumple
