#pragma once

// Finds which of two bodies has a component inside the other, where their surfaces do not meet: by a ray from a vertex
// of each component that lies in the other's box.
//
//   pairs of bodies --components, boxes--> rays, by the body whose faces they are taken through
//   each such body, on one worker: posed vertices, all its rays at once --> flags of pairs
//
// Winding numbers are constant on a component then, but for one case: with welding, surfaces that have nothing but
// welded vertices, and edges and faces between such, in common do not meet either. These vertices part a component, so
// that a ray starts from each of its other vertices.

#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/intersections.h"
#include "search/containment/closed_bodies.h"
#include "search/containment/winding_rays.h"

namespace crumple {

/// Leaves the pairs that may change a result of intersections, which has so much output: `any`, `any_by_world` or
/// `body_pairs`. The surfaces of these pairs do not meet.
void leave_undecided(const WorldOutline& outline, Output output, const Intersections& found, Array<BodyPair>& pairs);

class ContainedBodies {
   public:
    /// `weld`: vertices of different bodies at equal positions are one.
    ContainedBodies(MemoryMeter& meter, Cancellation& cancellation, const ClosedBodies& bodies, bool weld)
        : meter_(meter), cancellation_(cancellation), bodies_(bodies), weld_(weld) {}

    /// Adds those of the pairs, which leave_undecided() has left, of which one has a component inside the other.
    void add(ParallelFor& workers, std::span<const BodyPair> pairs, Output output, Intersections& result) const;

   private:
    /// A ray through the faces of body `through`.
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
