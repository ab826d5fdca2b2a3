#pragma once

// Vertices of the scene of a call of stencils() (crumple/stencils.h): of meshes and of bodies alike.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "crumple/scene.h"
#include "crumple/stencils.h"
#include "scene/world_outline.h"

namespace crumple {

/// Scene and options of a call of stencils(): reads vertices of its bodies in the caller's memory.
class StencilScene {
   public:
    /// Throws Error for scenes and arrays that stencils() does not support. `needs_end`: true if the scene has to move.
    StencilScene(const Scene& scene, const StencilOptions& options, bool needs_end);
    StencilScene(const StencilScene&) = delete;
    StencilScene& operator=(const StencilScene&) = delete;

    std::int32_t bodies() const { return outline_.bodies(); }
    std::int64_t vertices(std::int32_t body) const { return outline_.shape(body).vertices.rows; }
    std::int64_t triangles(std::int32_t body) const { return outline_.shape(body).triangles.rows; }
    /// Returns the corners of a triangle, unchecked.
    std::array<std::int64_t, 3> corners(std::int32_t body, std::int32_t triangle) const;
    /// Returns the number of the first vertex of a body. For b = bodies(), the number of all vertices.
    std::int64_t first_vertex(std::int32_t body) const { return first_vertex_[static_cast<std::size_t>(body)]; }

    Vec3d start(std::int32_t body, std::int64_t vertex) const {
        return outline_.placement(body)(reader_of(outline_.shape(body))(vertex));
    }
    Vec3d end(std::int32_t body, std::int64_t vertex) const {
        return outline_.end_placement(body)(end_reader_of(outline_.shape(body))(vertex));
    }
    /// Return readers of the arrays of the options, by vertices of all bodies; none if an array is not given.
    /// @{
    const std::optional<VertexReader>& before() const { return before_; }
    const std::optional<VertexReader>& rest() const { return rest_; }
    /// @}

   private:
    std::vector<Shape> shapes_;  // of meshes
    std::vector<Body> bodies_;
    WorldOutline outline_{nullptr};
    std::vector<std::int64_t> first_vertex_;
    std::optional<VertexReader> before_, rest_;
};

}  // namespace crumple
