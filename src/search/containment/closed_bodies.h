#pragma once

// Bodies of worlds by their surfaces, which have to be closed where a winding number is needed: for queries about what
// lies inside what.
//
//   shapes --> surfaces: closed?, components, boxes; cached
//   bodies --boxes of surfaces under their poses--> wanted pairs whose boxes overlap

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/query.h"
#include "scene/body_rules.h"
#include "scene/closed_surface.h"
#include "scene/near_bodies.h"
#include "scene/orientation.h"
#include "scene/world_outline.h"
#include "search/containment/placed_surface.h"

namespace crumple {

class ClosedBodies {
   public:
    ClosedBodies(MemoryMeter& meter, Cancellation& cancellation);

    /// Reads a world, whose bodies have to stay while this is used. `weld`: vertices of a shape at equal positions are
    /// one. Throws Error (invalid_argument). Cost: O(triangles of the shapes).
    void read(BackendBase& backend, const World& world, const PairFilter& filter, bool weld);
    /// Gives all memory back.
    void release();

    const WorldOutline& outline() const { return outline_; }
    /// Holds the vertices of a body; a little too large.
    const Bounds& box(std::int32_t body) const { return near_.box(body); }
    const ClosedSurface& surface(std::int32_t body) const { return surface_of(body).closed; }
    bool is_closed(std::int32_t body) const { return surface(body).closed(); }
    /// Returns −1 if the pose of a body turns it inside out: its faces are meant to be reversed then.
    int orientation(std::int32_t body) const { return orientation_of(outline_.placement(body)) < 0 ? -1 : 1; }

    /// Returns the wanted pairs of bodies whose boxes overlap, in order: of different bodies, and with `self` also of
    /// bodies with themselves. Where a surface is not closed, the boxes are those of the vertices.
    Array<BodyPair> near_pairs(bool self) const;
    /// Returns the bodies of these pairs whose surfaces are not closed, ascending. Throws Error (invalid_argument)
    /// about the first one for OpenSurfaces::error; `query` has the options that its message names.
    std::vector<std::int32_t> open_bodies(std::span<const BodyPair> pairs, OpenSurfaces open, const char* query) const;

    /// The surface of a body under its pose, whose vertices are put into `points`. O(vertices).
    PlacedSurface place(std::int32_t body, Array<Vec3d>& points) const;
    /// An array for these, which the meter counts.
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
    void read_surfaces(BackendBase& backend, bool weld);

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    WorldOutline outline_;
    BodyRules rules_;
    NearBodies near_;
    SceneBuffers buffers_;
    std::vector<std::unique_ptr<Surface>> surfaces_;  ///< by shape; cached
};

}  // namespace crumple
