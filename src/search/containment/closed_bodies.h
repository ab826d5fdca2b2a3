#pragma once

// Surfaces of the bodies of worlds, for queries about bodies inside others. A surface must be closed if its winding
// number is needed.
//
//   shapes --> surfaces: closed?, components, boxes; cached
//   bodies --boxes of surfaces under their poses--> selected pairs whose boxes overlap

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/query.h"
#include "scene/body_filter.h"
#include "scene/closed_surface.h"
#include "scene/near_bodies.h"
#include "scene/orientation.h"
#include "scene/world_outline.h"
#include "search/containment/placed_surface.h"

namespace crumple {

class ClosedBodies {
   public:
    ClosedBodies(MemoryMeter& meter, Cancellation& cancellation);

    /// Reads a world, whose arrays must outlive the use of this object. `weld`: merges vertices of a shape at equal
    /// positions. Throws Error (invalid_argument). Cost: O(triangles of the shapes).
    void read(ParallelFor& workers, const World& world, const PairFilter& filter, bool weld);
    /// Frees all memory.
    void release();

    const WorldOutline& outline() const { return outline_; }
    /// Returns a box that contains a body's posed vertices; it is not tight.
    const Bounds& box(std::int32_t body) const { return near_.box(body); }
    const ClosedSurface& surface(std::int32_t body) const { return surface_of(body).closed; }
    bool is_closed(std::int32_t body) const { return surface(body).closed(); }
    /// Returns −1 if the pose of a body mirrors it, so that its faces have to be reversed, else 1.
    int orientation(std::int32_t body) const { return orientation_of(outline_.placement(body)) < 0 ? -1 : 1; }

    /// Returns the pairs of bodies that the filter selects and whose boxes overlap, sorted: of different bodies, and
    /// with `self` also of bodies with themselves. If one of the two surfaces is not closed, the tight boxes of the
    /// posed vertices must overlap, so that fewer open surfaces are errors.
    Array<BodyPair> near_pairs(bool self) const;
    /// Returns the bodies in `pairs` whose surfaces are not closed, ascending. If `open` is OpenSurfaces::error and
    /// there are any, throws Error (invalid_argument) about the first one; `query`: name of the query whose options the
    /// message mentions.
    std::vector<std::int32_t> open_bodies(std::span<const BodyPair> pairs, OpenSurfaces open, const char* query) const;

    /// Returns the surface of a body under its pose; `points` gets the posed vertices and must outlive the result.
    /// O(vertices). Throws Error (not_finite) if the pose makes a coordinate infinite.
    PlacedSurface place(std::int32_t body, Array<Vec3d>& points) const;
    /// False if, because of the bodies' boxes, no component of one body can lie inside the other. O(components).
    bool may_enclose(std::int32_t a, std::int32_t b) const;
    /// Returns an empty array, counted by the meter, for the points of place().
    Array<Vec3d> metered_points() const { return Array<Vec3d>(&meter_); }

   private:
    struct Surface {
        explicit Surface(MemoryMeter* m) : closed(m) {}
        ClosedSurface closed;
        CentredBox box;
        bool empty = true;
    };

    const Surface& surface_of(std::int32_t body) const {
        return *surfaces_[static_cast<std::size_t>(outline_.body(body).shape)];
    }
    void read_surfaces(ParallelFor& workers, bool weld);
    PreparedScene prepare_shape(std::size_t s, bool weld, ParallelFor& workers);
    bool has_component_in_box(std::int32_t body, std::int32_t other) const;

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    WorldOutline outline_;
    BodyFilter rules_;
    NearBodies near_;
    SceneBuffers buffers_;
    std::vector<std::unique_ptr<Surface>> surfaces_;  ///< by shape; cached between calls
};

}  // namespace crumple
