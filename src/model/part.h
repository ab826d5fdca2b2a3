#pragma once

// Membership of triangles in the public parts of a scene ([MZ] sec. 1.1; rule and proof in docs/subdivide.md).
//
// Machines that answer different parts must agree on every bit of every mask, so this is plain float64 arithmetic
// without contraction, the same on every processor and backend.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/detector.h"
#include "geometry/normaliser.h"
#include "model/scene.h"

namespace crumple {

/// Bit k of masks[t]: triangle t belongs to the part with centres[k]. 0 for triangles that `part` does not list; one
/// without lists stands for all triangles.
void part_masks(const Scene& scene, const Part& part, ParallelFor& parallel, Array<std::uint64_t>& masks);

/// The pair is owned by the lowest part that both belong to.
inline bool owned_by(int part, std::uint64_t mask_a, std::uint64_t mask_b) {
    return std::countr_zero(mask_a & mask_b) == part;
}

/// The triangles that place the parts' centres: at most 4,096, evenly spread over the scene's order.
class PartSample {
   public:
    explicit PartSample(std::int64_t triangles)
        : triangles_(static_cast<std::size_t>(triangles)), centroids_(std::min<std::size_t>(triangles_, 4096)) {}
    std::size_t size() const { return centroids_.size(); }
    std::int64_t triangle(std::size_t i) const { return static_cast<std::int64_t>(i * triangles_ / size()); }
    void set(std::size_t i, const Triangle& triangle, const Normaliser& normalise);
    /// `count` fuzzy C-means centres, and no members yet.
    Part centres(int count, const Normaliser& normalise) const;

   private:
    std::size_t triangles_;
    std::vector<Vec3f> centroids_;
};

/// The parts around these centres: members by the masks of all triangles, of which `first_mesh` are the first mesh's.
std::vector<Part> list_members(const Part& centres, std::span<const std::uint64_t> masks, std::int64_t first_mesh);

/// Cuts a scene into `count` parts; depends only on the scene and the count.
std::vector<Part> make_parts(const Scene& scene, int count, ParallelFor& parallel);

}  // namespace crumple
