#pragma once

// Winding numbers of one surface at the vertices of another. In the order of a depth-first walk of the forest of edges
// (scene/closed_surface.h) they are piecewise constant, with steps where the surfaces cross.

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

/// Intervals of places of one surface, built from the steps of winding numbers at their ends.
class WindingSteps {
   public:
    void add(std::int32_t begin, std::int32_t end, std::int32_t winding) {
        if (winding == 0) return;
        steps_.push_back({begin, winding});
        steps_.push_back({end, -winding});
    }
    /// Adds the steps of another part of the same surface.
    void add(const WindingSteps& part) { steps_.insert(steps_.end(), part.steps_.begin(), part.steps_.end()); }
    /// Adds the changes of the winding number along the edges of a face.
    void add_jumps(const ClosedSurface& surface, std::int32_t face, const EdgeJumps& jumps);
    /// Adds the winding numbers of `other`, which is shifted, at the first vertex of each component of `of`. Call after
    /// all steps of edges have been added.
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
