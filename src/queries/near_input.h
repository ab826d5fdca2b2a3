#pragma once

// What questions about nearness are given of each vertex beside where it is: a radius, and where it is at rest. Shapes
// have it; a scene of several bodies gets it one body after the other.

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

/// Throws Error (invalid_argument) that names the first radius, after `which`, that is none.
void check_radii(const std::string& which, std::span<const double> radii);

class NearInput {
   public:
    explicit NearInput(MemoryMeter* meter) : given_radii_(meter), points_(meter), body_(meter), rings_(meter) {}

    /// Reads and checks what the question and its shapes say. `bodies`: see FeatureSearch. `here`: arrays lie on the
    /// host; else their contents are not looked at. Throws Error
    /// (invalid_argument, not_finite) that names shape and vertex.
    void begin(const WorldOutline& outline, const ProximityQuery& question, bool bodies, bool here,
               ParallelFor& workers, SceneBuffers& buffers);

    /// For a scene that is the only body, where the caller has it; or for one of several.
    void place(const Shape& only);
    void place(const WorldOutline& outline, const WorldScene& scene);

    /// Tells the query of all that, of a scene of so many vertices and with these features. It stays where it is.
    void tell(std::int64_t vertices, ParallelFor& workers, Cancellation& cancellation, FeatureRequest& query);

    /// Gives all memory back.
    void release();

   private:
    // Of the call:
    bool any_radii_ = false, any_rest_ = false;
    std::int32_t ring_count_ = 0;
    // Of the scene:
    std::span<const double> radii_;
    RestShape rest_;
    Array<double> given_radii_, points_;  ///< where several bodies' are put together: one and three a vertex
    Array<std::int32_t> body_;            ///< see RestShape
    VertexRings rings_;
};

}  // namespace crumple
