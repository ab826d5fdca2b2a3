#pragma once

// Winding numbers of one surface at the vertices of another. The place of a vertex is its position in a depth-first
// walk of a spanning forest of edges (scene/closed_surface.h). In the order of places, winding numbers are piecewise
// constant, with steps where the surfaces cross.

#include <cstdint>
#include <vector>

#include "base/cancellation.h"
#include "base/memory_claim.h"
#include "exact/overlap/face_crossing.h"
#include "scene/closed_surface.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// Interval of places with constant winding number.
struct WindingInterval {
    std::int32_t begin, end, winding;
};

/// Intervals of places of one surface, built from steps: changes of the winding number at a place.
class WindingSteps {
   public:
    void add(std::int32_t begin, std::int32_t end, std::int32_t winding) {
        if (winding == 0) return;
        steps_.push_back({begin, winding});
        steps_.push_back({end, -winding});
    }
    /// Adds steps of the same surface that were computed separately.
    void add(const WindingSteps& part) { steps_.insert(steps_.end(), part.steps_.begin(), part.steps_.end()); }
    /// Adds a step for each edge of the face that is in the forest and along which the winding number changes.
    void add_jumps(const ClosedSurface& surface, std::int32_t face, const EdgeJumps& jumps);
    /// Adds the winding numbers of `other`, which is shifted (exact/overlap/face_crossing.h), at the first vertex of
    /// each component of `of`. Call after the steps of all edges have been added.
    void add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift, Cancellation& cancellation);

    std::size_t bytes() const { return bytes_of(steps_) + bytes_of(intervals_); }

    /// Computes the intervals from the steps.
    void make_intervals();

    /// Returns the intervals whose winding number is not 0, in order.
    const std::vector<WindingInterval>& intervals() const { return intervals_; }
    std::int32_t winding_at(std::int32_t place) const;

   private:
    struct Step {
        std::int32_t place, change;
        friend auto operator<=>(const Step&, const Step&) = default;
    };
    std::vector<Step> steps_;
    std::vector<WindingInterval> intervals_;
};

}  // namespace crumple
