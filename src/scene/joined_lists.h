#pragma once

// Edges and points that shapes list, checked, and joined to those of one scene of several bodies. Bodies whose shape
// lists none have what is meant without a list: the edges of their triangles, the vertices that a triangle or an edge
// names.

#include <string>

#include "crumple/array.h"
#include "crumple/world.h"
#include "scene/scene_features.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {

/// What the shape lists, as it is. Throws Error: an edge or a point that names no vertex of the shape, an edge with
/// equal ends. `which` names the body: what messages begin with.
ListedFeatures checked_lists(const Shape& shape, const std::string& which);

class JoinedLists {
   public:
    explicit JoinedLists(MemoryMeter* meter) : edges_(meter), points_(meter), named_(meter) {}

    /// Of the bodies that were added to `bodies`, which is `scene`. `features` becomes that of the scene's triangles
    /// if some bodies list edges and others do not. Those of each body are one behind the other. Valid until the next
    /// call.
    ListedFeatures join(const WorldOutline& outline, const WorldScene& bodies, const PreparedScene& scene,
                        ParallelFor& workers, SceneFeatures& features);

   private:
    void join_edges(const WorldOutline& outline, const WorldScene& bodies, const Array<Edge>& of_triangles);
    void join_points(const WorldOutline& outline, const WorldScene& bodies, const PreparedScene& scene);

    Array<Edge> edges_;
    Array<std::int32_t> points_;
    Array<std::uint8_t> named_;  ///< of each vertex: by a triangle or an edge
};

}  // namespace crumple
