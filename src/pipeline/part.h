#pragma once

// Membership of triangles in the public parts of a scene ([MZ] sec. 1.1; rule and proof in docs/subdivide.md).
//
// Machines that answer different parts must agree on every bit of every mask, so this is plain float64 arithmetic
// without contraction, the same on every processor and backend.

#include <bit>
#include <cstdint>
#include <vector>

#include "crumple/array.h"
#include "crumple/detector.h"
#include "pipeline/parallel_for.h"
#include "pipeline/scene.h"

namespace crumple {

/// Bit k of masks[t]: triangle t belongs to the part with centres[k]. 0 for triangles that `part` does not list; one
/// without lists stands for all triangles.
void part_masks(const Scene& scene, const Part& part, ParallelFor& parallel, Array<std::uint64_t>& masks);

/// The pair is owned by the lowest part that both belong to.
inline bool owned_by(int part, std::uint64_t mask_a, std::uint64_t mask_b) {
    return std::countr_zero(mask_a & mask_b) == part;
}

/// Cuts a scene into `count` parts around fuzzy C-means centres; depends only on the scene and the count.
std::vector<Part> make_parts(const Scene& scene, int count, ParallelFor& parallel);

}  // namespace crumple
