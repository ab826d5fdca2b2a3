#pragma once

// Finds pairs of bodies of which one has a component inside the other, among pairs whose surfaces do not meet. For each
// component of one body that lies in the box of the other body, casts a ray from one of its vertices.
//
//   pairs of bodies --components, boxes--> rays, by the body through whose faces they are cast
//   each such body, on one worker: posed vertices, all its rays at once --> flags of pairs
//
// One ray suffices for a component, because the winding number of a surface that it does not meet is constant on it.
// There is one exception: with welding, surfaces do not count as meeting if they have only merged vertices, and edges
// and faces between these, in common. Such vertices may divide a component, so a ray starts from each of its other
// vertices.

#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "search/containment/closed_bodies.h"
#include "search/containment/winding_rays.h"

namespace crumple {

/// Removes the pairs that cannot change the result `found` of a search for intersections, whose output is `any`,
/// `any_by_world` or `body_pairs`. The surfaces of the remaining pairs do not meet.
void leave_undecided(const WorldOutline& outline, Output output, const Intersections& found, Array<BodyPair>& pairs);

class ContainedBodies {
   public:
    /// `weld`: vertices of different bodies at equal positions count as one.
    ContainedBodies(MemoryMeter& meter, Cancellation& cancellation, const ClosedBodies& bodies, bool weld)
        : meter_(meter), cancellation_(cancellation), bodies_(bodies), weld_(weld) {}

    /// Records in the result which of `pairs` have one body with a component inside the other: adds each such pair if
    /// the output is body_pairs, else sets the flag, or the flags of worlds. Call leave_undecided() on the pairs first.
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
