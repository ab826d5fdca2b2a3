#pragma once

// Validates the lists of edges and points of shapes, and joins the lists of several bodies to those of one scene. A
// body whose shape has no list contributes the default features: the edges of its triangles, and the vertices that a
// triangle or an edge names.

#include <string>

#include "crumple/array.h"
#include "crumple/world.h"
#include "scene/scene_features.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {

/// Returns the shape's lists, validated. Throws Error for an edge or a point that names no vertex of the shape, and for
/// an edge with equal ends. `which`: prefix of messages, which names the body.
CodimensionalFeatures checked_lists(const Shape& shape, const std::string& which);

class JoinedLists {
   public:
    explicit JoinedLists(MemoryMeter* meter) : edges_(meter), points_(meter), named_(meter) {}

    /// Joins the lists of the bodies in `bodies`, from which `scene` was made, body after body. If some bodies list
    /// edges and others do not, prepares `features` for the scene's triangles without lists, to get the default edges.
    /// The result is valid until the next call.
    CodimensionalFeatures join(const WorldOutline& outline, const WorldScene& bodies, const PreparedScene& scene,
                               ParallelFor& workers, SceneFeatures& features);

   private:
    void join_edges(const WorldOutline& outline, const WorldScene& bodies, const Array<Edge>& of_triangles);
    void join_points(const WorldOutline& outline, const WorldScene& bodies, const PreparedScene& scene);

    Array<Edge> edges_;
    Array<std::int32_t> points_;
    Array<std::uint8_t> named_;  ///< 1 for each vertex that a triangle or an edge names
};

}  // namespace crumple
