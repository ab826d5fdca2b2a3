#pragma once

// Input of proximity queries for each vertex: its radius, and its position in the rest shape. Shapes hold this input;
// for a scene of several bodies it is concatenated, body after body.

#include <span>
#include <string>

#include "base/cancellation.h"
#include "crumple/array.h"
#include "crumple/proximities.h"
#include "queries/feature_request.h"
#include "scene/rest_shape.h"
#include "scene/scene_features.h"
#include "scene/vertex_rings.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {

/// Throws Error (invalid_argument) that names the first radius that is negative or not finite. `which`: prefix of the
/// message.
void check_radii(const std::string& which, std::span<const double> radii);

class ProximityInput {
   public:
    explicit ProximityInput(MemoryMeter* meter) : given_radii_(meter), points_(meter), body_(meter), rings_(meter) {}

    /// Reads and checks the input of the query and the shapes. `bodies`: true if messages name shapes, false for a
    /// single mesh. `here`: true if the arrays are in host memory; if false, only their sizes are checked. Throws Error
    /// (invalid_argument, not_finite) that names the shape, and the vertex if one is at fault.
    void begin(const WorldOutline& outline, const ProximityQuery& query, bool bodies, bool here, ParallelFor& workers,
               SceneBuffers& buffers);

    /// Sets the scene: a single body, whose input is read in place, or a scene of several bodies, whose input is
    /// copied.
    void place(const Shape& only);
    void place(const WorldOutline& outline, const WorldScene& scene);

    /// Adds radii, rest shape and rings to a request. The request then refers to memory of this object. Makes the rings
    /// from the request's features. `vertices`: number of vertices of the scene.
    void tell(std::int64_t vertices, ParallelFor& workers, Cancellation& cancellation, FeatureRequest& query);

    /// Frees all memory.
    void release();

   private:
    // Per call:
    bool any_radii_ = false, any_rest_ = false;
    std::int32_t ring_count_ = 0;
    // Per scene:
    std::span<const double> radii_;
    RestShape rest_;
    Array<double> given_radii_, points_;  ///< radii (1 per vertex) and rest positions (3 per vertex), body after body
    Array<std::int32_t> body_;            ///< RestShape::body of a scene of several bodies
    VertexRings rings_;
};

}  // namespace crumple
