#pragma once

// Surface in coordinates in which a direction is vertical (exact/withdrawal/sheared_face.h), whose faces are found by
// their places. Rational numbers are computed when a face is first used, and cached.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "base/cancellation.h"
#include "base/memory_claim.h"
#include "base/parallel_for.h"
#include "exact/withdrawal/sheared_face.h"
#include "search/containment/placed_surface.h"
#include "search/withdrawal/projected_tree.h"

namespace crumple {

/// Interval of float64 numbers that contains a rational number.
struct RoundedBounds {
    double low, high;

    explicit RoundedBounds(const Rational& x);
};

/// Surface whose faces are found by their places.
class ShearedSurface {
   public:
    ShearedSurface(const PlacedSurface& surface, const ProjectionAlong& projection, const Shear& shear,
                   ParallelFor& workers, Cancellation& cancellation, MemoryMeter& meter)
        : surface_(surface),
          projection_(projection),
          shear_(shear),
          tree_(surface, projection, workers, cancellation),
          memory_(meter),
          memory_of_clean_(meter) {}

    const PlacedSurface& surface() const { return surface_; }
    ProjectedTree& tree() { return tree_; }
    /// Returns a face, which is cached until forget_faces() frees it.
    const ShearedFace& face(std::int32_t face);
    /// Frees memory if many faces are cached, some megabytes; invalidates references to faces.
    void forget_faces() {
        if (faces_.size() <= most_cached_faces) return;
        faces_.clear();
        memory_.release();
    }

    /// Returns the faces whose closed projection contains a place, and that are not upright.
    std::vector<const ShearedFace*> faces_at(const ShearedPlace& place);
    /// Returns the other faces whose boxes overlap that of a face, in the projection and in height.
    std::vector<std::int32_t> neighbours(std::int32_t face);
    /// True if a face meets no other face except at vertices and edges that they share.
    bool is_clean(std::int32_t face);

   private:
    static constexpr std::size_t most_cached_faces = 4096;

    template <class Test, class Visit>
    void walk(Test test, Visit visit);

    const PlacedSurface& surface_;
    const ProjectionAlong& projection_;
    const Shear& shear_;
    ProjectedTree tree_;
    std::unordered_map<std::int32_t, ShearedFace> faces_;
    std::unordered_map<std::int32_t, bool> clean_;
    MemoryClaim memory_;           ///< memory of faces_
    MemoryClaim memory_of_clean_;  ///< memory of clean_
};

}  // namespace crumple
