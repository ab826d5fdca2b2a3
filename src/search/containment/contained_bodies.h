#pragma once

// Finds pairs of bodies of which one has a component inside the other, if their surfaces do not meet: by a ray from a
// vertex of each component that lies in the other's box.
//
//   pairs of bodies --components, boxes--> rays, by the body through whose faces they are cast
//   each such body, on one worker: posed vertices, all its rays at once --> flags of pairs
//
// Then winding numbers are constant on each component, with one exception: with welding, surfaces also do not meet if
// they have only merged vertices, and edges and faces between these, in common. Such vertices may divide a component,
// so a ray starts from each of its other vertices.

#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "search/containment/closed_bodies.h"
#include "search/containment/winding_rays.h"

namespace crumple {

/// Removes pairs that cannot change a result of intersections with this output: `any`, `any_by_world` or `body_pairs`.
/// The surfaces of the remaining pairs do not meet.
void leave_undecided(const WorldOutline& outline, Output output, const Intersections& found, Array<BodyPair>& pairs);

class ContainedBodies {
   public:
    /// `weld`: vertices of different bodies at equal positions count as one.
    ContainedBodies(MemoryMeter& meter, Cancellation& cancellation, const ClosedBodies& bodies, bool weld)
        : meter_(meter), cancellation_(cancellation), bodies_(bodies), weld_(weld) {}

    /// Adds to the result those of the pairs, filtered by leave_undecided(), of which one body has a component inside
    /// the other.
    void add(ParallelFor& workers, std::span<const BodyPair> pairs, Output output, Intersections& result) const;

   private:
    /// Ray through the faces of body `through`.
    struct Cast {
        std::int32_t through;
        WindingRay ray;
    };
    using Casts = Array<Cast>;

    Casts casts_of(ParallelFor& workers, std::span<const BodyPair> pairs) const;
    void add_casts(std::int32_t of, std::int32_t through, std::size_t pair, Casts& casts) const;
    bool add_casts_between_welded(std::int32_t of, std::int32_t through, std::size_t pair, Casts& casts) const;
    Array<Vec3d> vertices_in(std::int32_t body, const Bounds& box) const;

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const ClosedBodies& bodies_;
    bool weld_;
};

}  // namespace crumple
